"""Every allocation and every call into the system of a small run fails once, or the process dies there: the folder asked
for then holds the former result or the whole new one, standard error one line, and the next run leaves nothing beside."""

import collections
import concurrent.futures
import errno
import functools
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import threading
import unittest

from cli import EDGES, PROGRAM, TINY_PATIENT, hashes, run, shared_folder

SHIM = os.environ["DYNASURF_FAULT_SHIM"]
# Runs per test; "all" makes a campaign of it, in which every call fails in every way.
RUNS = os.environ.get("DYNASURF_FAULTS", "24")
WORKERS = os.cpu_count()
# What a run may say whose result stands there all the same: only its last words, or the certainty that the result
# outlasts a power cut, were lost.
AFTER_THE_RESULT = ("stands there", "cannot write to standard output", "out of memory")
# Code of others that does not look at what it is given, and crashes: the dictionary of DCMTK and the loader of the system.
# The program looks for memory just before it calls them; here they are denied it all the same.
NOT_OURS = ("DcmDataDictionary", "(dlopen+")
# What a full disk, a broken one, a full table of files, a refusal and a signal make of a call.
CALL_ACTIONS = [str(errno.EIO), "die", str(errno.ENOSPC), "torn", str(errno.EMFILE), "short", str(errno.EACCES),
                str(errno.EINTR), str(errno.ENOMEM)]


@functools.cache
def study():
    made = run("phantom", "patient", "--seed", 7, "--out", shared_folder() / "tiny", *TINY_PATIENT)
    assert made.returncode == 0, made.stderr
    return shared_folder() / "tiny" / "study.dcm"


@functools.cache
def scan():
    made = run("phantom", "cloud", "--seed", 3, "--out", shared_folder() / "scan", "--set", "shape=ellipsoid", "--set",
               "points=500")
    assert made.returncode == 0, made.stderr
    return shared_folder() / "scan" / "cloud.ply"


@functools.cache
def levels():
    made = run("cloud", scan(), "--out", shared_folder() / "levels", "--triangles", "160,80", "--quiet")
    assert made.returncode == 0, made.stderr
    return shared_folder() / "levels"


# Command line of the former result and of the new one.
JOBS = {
    "ventricle": lambda new: ["ventricle", study(), "--no-timings", "--quiet", *EDGES, "--set", f"mesh_level={1 + new}"],
    "cloud": lambda new: ["cloud", scan(), "--no-timings", "--quiet", "--triangles", str(80 + 80 * new)],
    "phantom": lambda new: ["phantom", "patient", "--quiet", "--seed", str(new), *TINY_PATIENT, "--set", "gates=1"],
    "lod": lambda new: ["lod", levels(), "--steps", str(1 + new)],
}


def spread(numbers, most):
    """At most `most` of the numbers, from all over the list."""
    if most >= len(numbers):
        return list(numbers)
    return [numbers[i * len(numbers) // most] for i in range(most)]


class Job:
    """One command line with a former result, and the places in which runs of it are disturbed, one per thread."""

    def __init__(self, name, folder):
        self.arguments = [[*map(str, JOBS[name](new))] for new in (0, 1)]
        self.folder = pathlib.Path(folder)
        self.local = threading.local()
        for new, results in enumerate(("former", "new")):
            done = run(*self.arguments[new], "--out", self.folder / results)
            assert done.returncode == 0, done.stderr
        self.former, self.new = hashes(self.folder / "former"), hashes(self.folder / "new")
        assert self.former != self.new

    def place(self):
        """A folder that holds nothing but the former result."""
        if not hasattr(self.local, "place"):
            self.local.place = pathlib.Path(tempfile.mkdtemp(dir=self.folder)) / "place"
        if not self.local.place.exists():
            self.local.place.mkdir()
        out = self.local.place / "result"
        if not out.exists() or hashes(out) != self.former:
            shutil.rmtree(out, ignore_errors=True)
            shutil.copytree(self.folder / "former", out)
        return self.local.place

    def run(self, place, threads=(), limit=300, **fault):
        variables = {"DYNASURF_FAULT_" + name.upper(): str(value) for name, value in fault.items()}
        return subprocess.run([PROGRAM, *self.arguments[1], *threads, "--out", place / "result"],
                              stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                              errors="replace", timeout=limit, env={**os.environ, **variables, "LD_PRELOAD": SHIM})

    def count(self, kind, threads=()):
        report = self.folder / f"count-{kind}"
        assert self.run(self.place(), threads, kind=kind, report=report).returncode == 0
        return int(report.read_text())

    def sites(self, threads):
        """The numbers of the allocations that come by a new chain of callers."""
        sites = self.folder / "sites"
        assert self.run(self.place(), threads, 3000, kind="memory", sites=sites).returncode == 0
        return [int(line) for line in sites.read_text().splitlines()]

    def disturb(self, fault, threads=()):
        """What one disturbed run left: "former ..." or "new". Raises AssertionError when it is anything else."""
        place = self.place()
        stack = place.parent / "stack"
        stack.unlink(missing_ok=True)
        done = self.run(place, threads, **fault, stack=stack)
        if done.returncode == -signal.SIGSEGV and any(name in stack.read_text() for name in NOT_OURS):
            assert hashes(place / "result") == self.former
            self.tidy(place)
            return "former, by a crash that is not ours"
        killed = done.returncode == -signal.SIGKILL
        expected = (0, 2, -signal.SIGKILL) if fault["action"] in ("die", "torn") else (0, 2)
        assert done.returncode in expected, (done.returncode, done.stderr)
        out = place / "result"
        now = hashes(out) if out.exists() else None
        assert now in (self.former, self.new), f"{done.returncode}: the result is torn: {now and sorted(now)}"
        if not killed:
            is_late = now == self.new and any(words in done.stderr for words in AFTER_THE_RESULT)
            assert is_late or now == (self.new if done.returncode == 0 else self.former), (done.returncode, done.stderr)
            lines = done.stderr.splitlines()
            assert len(lines) == (0 if done.returncode == 0 else 1), done.stderr
            assert all(line.startswith("dynasurf: error: ") for line in lines), done.stderr
        self.tidy(place)
        return "new" if now == self.new else "former"

    def tidy(self, place):
        """What the disturbed run left beside the result, the next one sweeps up."""
        if os.listdir(place) == ["result"]:
            return
        done = run(*self.arguments[1], "--out", place / "result")
        assert done.returncode == 0, f"the next run says {done.stderr}"
        assert os.listdir(place) == ["result"], f"the next run leaves {os.listdir(place)}"
        assert hashes(place / "result") == self.new


class Faults(unittest.TestCase):
    def campaign(self, name, plan):
        """`plan(job)` lists what is done to the runs: pairs of a fault and further arguments."""
        with tempfile.TemporaryDirectory(prefix="dynasurf-faults-") as folder:
            job = Job(name, folder)
            tasks = plan(job)
            seen, failures = collections.Counter(), []

            def disturb(task):
                try:
                    seen[job.disturb(*task)] += 1
                except (AssertionError, subprocess.TimeoutExpired) as failure:
                    failures.append(f"{task}: {failure}")
                    shutil.rmtree(job.local.place, ignore_errors=True)

            with concurrent.futures.ThreadPoolExecutor(WORKERS) as pool:
                list(pool.map(disturb, tasks))
            print(f"{name}: {len(tasks)} disturbed runs, left {dict(seen)}")
            self.assertEqual(failures, [], f"{len(failures)} of {len(tasks)}:\n" + "\n".join(failures))

    def fail_calls(self, name):
        def plan(job):
            numbers = range(1, job.count("system") + 1)
            print(f"{name}: {len(numbers)} calls into the system")
            if RUNS == "all":
                return [({"kind": "system", "at": n, "action": action},) for n in numbers for action in CALL_ACTIONS]
            return [({"kind": "system", "at": n, "action": CALL_ACTIONS[i % len(CALL_ACTIONS)]},)
                    for i, n in enumerate(spread(numbers, int(RUNS)))]
        self.campaign(name, plan)

    def fail_allocations(self, name):
        # On one thread the numbers of a run are those of the run before.
        threads = ("--threads", "1") if name != "lod" else ()

        def plan(job):
            sites, count = job.sites(threads), job.count("memory", threads)
            print(f"{name}: {count} allocations by {len(sites)} chains of callers")
            if RUNS == "all":
                numbers = sorted({*range(1, 301), *sites, *spread(range(1, count + 1), 2000)})
                return [({"kind": "memory", "at": n, "action": action}, threads) for n in numbers
                        for action in ("once", "onwards")]
            return [({"kind": "memory", "at": n, "action": ("once", "onwards")[i % 2]}, threads)
                    for i, n in enumerate(spread(sites, int(RUNS)))]
        self.campaign(name, plan)


def add_tests():
    def test_of(method, name):
        return lambda self: getattr(self, method)(name)
    for name in JOBS:
        setattr(Faults, f"test_{name}_survives_the_failure_of_every_call", test_of("fail_calls", name))
        setattr(Faults, f"test_{name}_survives_the_failure_of_allocations", test_of("fail_allocations", name))


add_tests()

if __name__ == "__main__":
    unittest.main()
