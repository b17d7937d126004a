"""kill -9 at random moments of a run: the folder asked for holds nothing, the former result, or the whole new one."""

import os
import pathlib
import random
import shutil
import signal
import subprocess
import time
import unittest

from cli import EDGES, PROGRAM, TINY_PATIENT, CliTest, hashes, run

# Over all commands. A full campaign: DYNASURF_KILLS=10000, which DYNASURF_KILL_SECONDS ends earlier, for each command.
KILLS = int(os.environ.get("DYNASURF_KILLS", "200"))
SECONDS = float(os.environ.get("DYNASURF_KILL_SECONDS", "inf"))

# As process 1 of a name space of its own, as in a container.
UNSHARE = ["unshare", "--pid", "--fork"]


def can_unshare():
    return shutil.which("unshare") is not None and subprocess.run([*UNSHARE, "true"], capture_output=True).returncode == 0


def child_of(process):
    """The program inside its name space; None when it has not begun or has ended."""
    try:
        children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    except OSError:
        return None
    return int(children[0]) if children else None


class Kill(CliTest):
    def setUp(self):
        super().setUp()
        self.scan = self.folder / "scan"
        made = run("phantom", "cloud", "--out", self.scan, "--set", "shape=sphere", "--set", "points=2000")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.levels = self.folder / "levels"
        made = run("cloud", self.scan / "cloud.ply", "--out", self.levels, "--triangles", "320,80", "--quiet")
        self.assertEqual(made.returncode, 0, made.stderr)

    def start(self, command, out, apart=False):
        return subprocess.Popen([*(UNSHARE if apart else []), PROGRAM, *map(str, command), "--out", out],
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def kill(self, process, apart):
        """Whether it came in time."""
        pid = child_of(process) if apart else process.pid
        try:
            if pid is not None:
                os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        return process.wait() != 0 and pid is not None  # unshare has codes of its own for a killed child

    def whole(self, command, name):
        """What an undisturbed run leaves, and how long it takes."""
        begin = time.monotonic()
        self.assertEqual(self.start(command, self.folder / name).wait(), 0)
        return hashes(self.folder / name), time.monotonic() - begin

    def kill_often(self, first, second):
        """Two commands take turns at one place; every other one runs in a name space of its own."""
        kills = max(1, KILLS // 4)
        (old, seconds), (new, _) = self.whole(first, "whole-1"), self.whole(second, "whole-2")
        self.assertNotEqual(old, new)
        may_unshare = can_unshare()
        rng = random.Random(20260101)
        place = self.folder / "place"
        place.mkdir()
        out = place / "result"
        seen = {"nothing": 0, "former": 0, "new": 0}
        killed = runs = 0
        end = time.monotonic() + SECONDS
        while killed < kills and runs < 6 * kills + 20 and time.monotonic() < end:
            before = hashes(out) if out.exists() else None
            after, command = (new, second) if before != new else (old, first)
            apart = may_unshare and runs % 2 == 1
            process = self.start(command, out, apart)
            time.sleep(rng.uniform(0, seconds))
            was_killed = self.kill(process, apart)
            # How long a run takes changes with the load of the machine; the kills should fall all over it.
            seconds *= 1.05 if was_killed else 0.85
            killed += was_killed
            runs += 1
            now = hashes(out) if out.exists() else None
            self.assertIn(now, [before, after], f"run {runs}")
            seen["nothing" if now is None else "new" if now == after else "former"] += 1
            # Every fourth run starts from nothing.
            if runs % 4 == 0 and out.exists():
                shutil.rmtree(out)
        print(f"{first[0]}: {killed} of {runs} runs killed: {seen}")
        if time.monotonic() < end:
            self.assertEqual(killed, kills)
        self.assertGreater(seen["new"], 0)
        # What killed runs left beside is swept up by the next one.
        self.assertEqual(self.start(first, out).wait(), 0)
        self.assertEqual([path.name for path in place.iterdir()], ["result"])

    def test_leaves_no_ventricle_half_done(self):
        made = run("phantom", "patient", "--out", self.folder / "tiny", *TINY_PATIENT)
        self.assertEqual(made.returncode, 0, made.stderr)
        common = ["ventricle", self.folder / "tiny" / "study.dcm", "--no-timings", "--quiet", *EDGES, "--set"]
        self.kill_often([*common, "mesh_level=1"], [*common, "mesh_level=2"])

    def test_leaves_no_cloud_half_done(self):
        common = ["cloud", self.scan / "cloud.ply", "--no-timings", "--quiet", "--triangles"]
        self.kill_often([*common, "80"], [*common, "160"])

    def test_leaves_no_phantom_half_done(self):
        common = ["phantom", "cloud", "--quiet", "--set"]
        self.kill_often([*common, "points=700"], [*common, "points=900"])

    def test_leaves_no_levels_half_done(self):
        common = ["lod", self.levels, "--steps"]
        self.kill_often([*common, 1], [*common, 2])


if __name__ == "__main__":
    unittest.main()
