"""Where the system refuses threads, the work goes on with those that started, and its result has the same bytes."""

import os
import pathlib
import resource
import shutil
import subprocess
import tempfile
import unittest

from cli import PROGRAM, TINY_PATIENT, hashes

# Who else runs nothing: the limit is on all threads of a user, and the administrator has none.
NOBODY = 61234


def as_nobody_with(threads):
    def prepare():
        os.setgroups([])
        os.setgid(NOBODY)
        resource.setrlimit(resource.RLIMIT_NPROC, (threads, threads))
        os.setuid(NOBODY)
    return prepare


@unittest.skipUnless(os.geteuid() == 0, "only the administrator may run programs as somebody else")
class Threads(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="dynasurf-threads-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.folder.chmod(0o777)
        self.program = shutil.copy(PROGRAM, self.folder / "dynasurf")  # the folder it is built in may be closed

    def run_with(self, threads, out, *arguments):
        done = subprocess.run([self.program, *arguments, "--quiet", "--out", self.folder / out], stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, timeout=300, preexec_fn=as_nobody_with(threads))
        self.assertEqual((done.returncode, done.stderr), (0, ""), f"{threads} threads")
        return hashes(self.folder / out)

    def test_fewer_are_enough(self):
        common = ["phantom", "patient", *TINY_PATIENT]
        whole = self.run_with(1000, "patient", *common)
        for threads in (1, 2, 3, 5):
            for asked in ([], ["--threads", "8"]):
                with self.subTest(threads=threads, asked=asked):
                    self.assertEqual(self.run_with(threads, f"patient-{threads}-{len(asked)}", *common, *asked), whole)

    def test_one_is_enough_for_a_reconstruction(self):
        self.run_with(1000, "patient", "phantom", "patient", *TINY_PATIENT)
        common = ["ventricle", self.folder / "patient" / "study.dcm", "--no-timings", "--preset", "edges"]
        whole = self.run_with(1000, "whole", *common)
        for threads in (1, 2, 4):
            self.assertEqual(self.run_with(threads, f"result-{threads}", *common, "--threads", "8"), whole)


if __name__ == "__main__":
    unittest.main()
