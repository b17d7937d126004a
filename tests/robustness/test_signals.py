"""The first Ctrl-C, SIGTERM or SIGHUP ends every command soon, in one line, and nothing half done stays behind."""

import fcntl
import functools
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import time
import unittest

from cli import EDGES, PROGRAM, CliTest, hashes, run, shared_folder, small_patient, small_result

# Commands that write have something to clean up; the others have not.
SOON_S, AT_ONCE_S = 1.0, 0.2
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
STOPPED = "dynasurf: error: stopped on request; "
NOTHING, BEFORE = STOPPED + "nothing was written\n", STOPPED + "the result had been written before\n"


def load():
    """How much longer than on an idle machine a short run of the program takes now."""
    usual_s = 0.06
    times = []
    for _ in range(3):
        begin = time.monotonic()
        run("--version")
        times.append(time.monotonic() - begin)
    return min(8, max(1, max(times) / usual_s))


def full_pipe():
    """Both ends of a pipe that takes nothing more: who prints to it waits for ever."""
    reader, writer = os.pipe()
    fcntl.fcntl(writer, fcntl.F_SETFL, os.O_NONBLOCK)
    try:
        while True:
            os.write(writer, bytes(4096))
    except BlockingIOError:
        pass
    fcntl.fcntl(writer, fcntl.F_SETFL, 0)
    return reader, writer


def watches(pid):
    """Whether the process has begun to wait for signals itself."""
    try:
        status = pathlib.Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return False
    mask = next((line.split()[1] for line in status.splitlines() if line.startswith("SigBlk")), "0")
    return int(mask, 16) >> (signal.SIGTERM - 1) & 1 == 1


def wait_until(holds, seconds=60):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if holds():
            return True
        time.sleep(0.005)
    return False


def processes_with(mark):
    """Processes whose environment holds a text, as /proc tells."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and mark.encode() in (entry / "environ").read_bytes():
                found.append(int(entry.name))
        except OSError:
            continue
    return found


@functools.cache
def scan():
    folder = shared_folder() / "big-scan"
    made = run("phantom", "cloud", "--seed", 3, "--out", folder, "--set", "shape=ellipsoid", "--set", "points=60000")
    assert made.returncode == 0, made.stderr
    return folder


@functools.cache
def cloud_result():
    folder = shared_folder() / "cloud-result"
    made = run("cloud", scan() / "cloud.ply", "--out", folder, "--triangles", "5120,1280")
    assert made.returncode == 0, made.stderr
    return folder


@functools.cache
def big_study():
    """Many gates, so that it is read for a while."""
    folder = shared_folder() / "big-study"
    made = run("phantom", "patient", "--seed", 7, "--out", folder, "--set", "gates=32", "--set", "lattice.nx=100",
               "--set", "lattice.ny=100")
    assert made.returncode == 0, made.stderr
    return folder


@functools.cache
def long_mesh():
    path = shared_folder() / "long.ply"
    rows = b"".join(b"%d.5 %d.25 0.125\n" % (n, n * n % 1009) for n in range(1000)) * 600
    faces = b"".join(b"3 %d %d %d\n" % (n, n + 1, n + 2) for n in range(1000)) * 400
    path.write_bytes(b"ply\nformat ascii 1.0\nelement vertex 600000\nproperty float x\nproperty float y\nproperty float z\n"
                     b"element face 400000\nproperty list uchar int vertex_indices\nend_header\n" + rows + faces)
    return path


@functools.cache
def many_results():
    folder = shared_folder() / "many"
    folder.mkdir()
    for n in range(2000):
        (folder / f"r{n}").symlink_to(small_result())
    return folder


@functools.cache
def many_points():
    path = shared_folder() / "points.csv"
    rng = random.Random(1)
    places = [[rng.uniform(-40, 40) for _ in range(3)] for _ in range(1500)]
    rows = [f"p{n},{gate},{x + gate:.4f},{y:.4f},{z:.4f}" for gate in range(1, 9) for n, (x, y, z) in enumerate(places)]
    path.write_text("point,gate,x_mm,y_mm,z_mm\n" + "\n".join(rows) + "\n")
    return path


# "surfaces 2/8"
PROGRESS = re.compile(r"[a-z_ ]+ \d+/\d+\n")
SLOW_FIT = ["--set", "mesh_level=4", "--set", "field=gvf", "--set", "field.iterations=200000", "--quiet"]


def commands():
    """Name -> arguments, and the name of what it writes with --out."""
    study = small_patient() / "study.dcm"
    return {
        "ventricle": (["ventricle", study, *SLOW_FIT], "result"),
        "ventricle at the end": (["ventricle", study, *EDGES], "result"),
        "cloud": (["cloud", scan() / "cloud.ply", "--triangles", "200000", "--quiet"], "result"),
        "lod": (["lod", cloud_result(), "--steps", "200"], "lod"),
        "edges": (["borders", "--edges-only", big_study() / "study.dcm", "--quiet"], "sheets"),
        "borders": (["borders", big_study() / "study.dcm", "--quiet"], "sheets"),
        "phantom": (["phantom", "patient", "--set", "gates=64", "--quiet"], "phantom"),
        "phantom cloud": (["phantom", "cloud", "--set", "points=3000000", "--quiet"], "phantom"),
        "phantom camera": (["phantom", "camera", "--quiet"], "phantom"),
        "organ": (["organ", big_study() / "study.dcm"], "organ"),
        "motion": (["motion", many_points(), "--apex", "0,0,-45", "--base", "0,0,45", "--quiet"], "motion"),
        "compare": (["perfusion", "compare", small_result(), small_result()], "both"),
        "normals": (["perfusion", "build", many_results()], "normals.json"),
        "scores": (["perfusion", "score", small_result()], "scores.json"),
        "solid": (["solid", small_result(), "--rings", "200", "--sectors", "400", "--layers", "10"], "wall.vtu"),
        "info": (["info", big_study() / "study.nii.gz"], None),
        "measure": (["measure", long_mesh()], None),
        "options": (["options", "ventricle"], None),
        "lod without out": (["lod", cloud_result()], None),
        "compare without out": (["perfusion", "compare", small_result(), small_result()], None),
        "scores without out": (["perfusion", "score", small_result()], None),
    }


class Stopping(CliTest):
    def place(self, name):
        """A folder with a former result of that name."""
        place = self.folder / "place"
        if place.exists():
            shutil.rmtree(place)
        place.mkdir()
        return place, place / name

    def start(self, arguments, **options):
        reader, writer = full_pipe()
        self.addCleanup(os.close, reader)
        process = subprocess.Popen([PROGRAM, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=writer,
                                   stderr=subprocess.PIPE, text=True, **options)
        os.close(writer)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.assertTrue(wait_until(lambda: watches(process.pid) or process.poll() is not None))
        return process

    def end(self, process, sent, limit_s, what):
        """Sends the signal, and returns the seconds until the process is gone and what it said."""
        process.send_signal(sent)
        asked = time.monotonic()
        try:
            process.wait(30)
        except subprocess.TimeoutExpired:
            self.fail(f"{what}: runs on")
        took = time.monotonic() - asked
        self.assertLess(took, limit_s * load(), what)
        said = process.stderr.read()
        return "".join(line for line in said.splitlines(True) if not PROGRESS.fullmatch(line))


class Signals(Stopping):
    def check(self, name, arguments, writes, sent, delay):
        what = f"{name}, {sent.name} after {delay:.2f} s"
        place, out = self.place(writes or "none")
        beside = sorted(path.name for path in small_result().parent.iterdir())
        process = self.start([*arguments, *(["--out", out] if writes else [])], cwd=place)
        time.sleep(delay)
        if process.poll() is not None:
            return None  # refused, or done without a word
        said = self.end(process, sent, SOON_S if writes else AT_ONCE_S, what)
        self.assertEqual(sorted(path.name for path in small_result().parent.iterdir()), beside, what)
        there = sorted(path.name for path in place.iterdir())
        if process.returncode == 0:  # done before the signal was seen
            self.assertEqual((said, there), ("", [writes] if writes else []), what)
            return None
        self.assertEqual(process.returncode, 3, f"{what}: {said}")
        if said == BEFORE:
            self.assertEqual(there, [writes], what)
        else:
            self.assertEqual((said, there), (NOTHING, []), what)
        return said

    def test_end_every_command_soon(self):
        rng = random.Random(20260102)
        for name, (arguments, writes) in commands().items():
            with self.subTest(name):
                said = [self.check(name, arguments, writes, sent, rng.uniform(0.05, 0.5)) for sent in SIGNALS]
                self.assertTrue(any(said), f"{name}: ended before it was stopped, {said}")

    def test_leave_the_former_result_or_a_whole_new_one_wherever_they_fall(self):
        study = small_patient() / "study.dcm"
        place, out = self.place("result")
        fast = ["--no-timings", "--quiet", *EDGES]
        begin = time.monotonic()
        self.assertEqual(run("ventricle", study, "--out", out, *fast).returncode, 0)
        seconds = time.monotonic() - begin
        old = hashes(out)
        run("ventricle", study, "--out", self.folder / "new", *fast, "--set", "edges.high=0.65")
        new = hashes(self.folder / "new")
        rng, seen = random.Random(20260103), {0: 0, 3: 0}
        for n in range(40):
            before, after, more = (old, new, ["--set", "edges.high=0.65"]) if hashes(out) == old else (new, old, [])
            process = subprocess.Popen([PROGRAM, "ventricle", study, "--out", out, *fast, *more],
                                       stderr=subprocess.PIPE, text=True)
            with process:
                wait_until(lambda: watches(process.pid))
                # The last part of a run is where it writes and publishes.
                time.sleep(seconds * (0.6 + 0.5 * rng.random()))
                process.send_signal(rng.choice(SIGNALS))
                said = process.stderr.read()
            self.assertIn(process.returncode, (0, 3), said)
            seen[process.returncode] += 1
            seconds *= 0.95 if process.returncode == 0 else 1.03
            stands = after if process.returncode == 0 or said == BEFORE else before
            self.assertEqual(hashes(out), stands, f"run {n}: exit {process.returncode}, {said}")
            self.assertEqual(said, "" if process.returncode == 0 else BEFORE if stands == after else NOTHING)
            self.assertEqual([path.name for path in place.iterdir()], ["result"], f"run {n}")
        print(f"stopped while it wrote: {seen}")

    def test_end_a_repeated_run_whose_scratch_goes_away(self):
        small_result()
        for sent in SIGNALS:
            beside = sorted(path.name for path in small_result().parent.iterdir())
            process = self.start(["rerun", small_result(), "--study", small_patient() / "study.dcm"])
            time.sleep(0.4)
            self.assertEqual(self.end(process, sent, SOON_S, "rerun"), NOTHING)
            self.assertEqual(process.returncode, 3)
            self.assertEqual(sorted(path.name for path in small_result().parent.iterdir()), beside)

    def test_the_second_one_does_not_wait(self):
        place, out = self.place("result")
        process = self.start(["ventricle", small_patient() / "study.dcm", "--out", out, *SLOW_FIT])
        time.sleep(0.1)
        process.send_signal(signal.SIGTERM)
        self.end(process, signal.SIGINT, AT_ONCE_S, "second signal")
        self.assertEqual(process.returncode, 3)


@unittest.skipUnless(shutil.which("chromium") or shutil.which("chromium-browser"), "Chromium is not there")
class Printing(Stopping):
    def printing(self):
        """A run whose browser is at work, and the folder for temporary files that all of its processes name."""
        temporary = self.folder / "tmp"  # short: the browser makes sockets there
        temporary.mkdir(exist_ok=True)
        place, out = self.place("result")
        process = self.start(["ventricle", small_patient() / "study.dcm", "--out", out, "--pdf", "--quiet", *EDGES],
                             env=os.environ | {"TMPDIR": str(temporary)})
        self.assertTrue(wait_until(lambda: len(processes_with(str(temporary))) > 2, 240), "the browser was not started")
        return process, place, temporary

    def test_the_browser_ends_with_the_run(self):
        for sent in SIGNALS:
            process, place, temporary = self.printing()
            said = self.end(process, sent, SOON_S, "printing")
            self.assertEqual((process.returncode, said), (3, NOTHING))
            self.assertEqual(list(place.iterdir()), [])
            self.assertTrue(wait_until(lambda: not processes_with(str(temporary)), 2), "the browser runs on")
            self.assertEqual(list(temporary.iterdir()), [])

    def test_the_browser_does_not_outlive_a_killed_run_and_the_next_one_sweeps(self):
        process, _, temporary = self.printing()
        process.kill()
        process.wait()
        self.assertTrue(wait_until(lambda: not processes_with(str(temporary)), 2), "the browser runs on")
        self.assertTrue(any(path.name.startswith("dynasurf-print-") for path in temporary.iterdir()))
        (temporary / "dynasurf-print-note").write_text("a file, not ours")
        elsewhere = self.folder / "elsewhere"
        elsewhere.mkdir(mode=0o700)
        (elsewhere / "precious").write_text("kept")
        (temporary / "dynasurf-print-link").symlink_to(elsewhere)
        made = run("perfusion", "compare", small_result(), small_result(), "--out", self.folder / "both", "--pdf",
                   env=os.environ | {"TMPDIR": str(temporary)})
        self.assertEqual(made.returncode, 0, made.stderr)
        ours = [path.name for path in temporary.iterdir() if path.name.startswith("dynasurf-")]
        self.assertEqual(sorted(ours), ["dynasurf-print-link", "dynasurf-print-note"])
        self.assertTrue((elsewhere / "precious").exists())


if __name__ == "__main__":
    unittest.main()
