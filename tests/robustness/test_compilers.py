"""The same bytes from every compiler and processor for which this machine can build, of what is built in seconds.
`./dev check --bytes` builds all libraries."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
SOURCES = ("core/elementary_angle", "core/elementary_exp", "core/elementary_root", "core/fourier", "core/symmetric_axes",
           "core/parallel", "core/parallel_serial", "core/trace", "synthetic/random", "psf_fit/matrix_loops", "psf_fit/cholesky")
FLAGS = ["-std=c++20", "-DNDEBUG", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math", "-DEIGEN_DONT_VECTORIZE",
         f"-I{ROOT / 'src'}", "-isystem/usr/include/eigen3"]


class Compilers(unittest.TestCase):
    def compare(self, *compiler, runner=()):
        for program in (compiler[0], *runner[:1]):
            if not shutil.which(program):
                self.skipTest(f"{program} is missing")
        # All in one unit: Eigen takes longest to read.
        parts = [ROOT / f"src/dynasurf/{name}.cpp" for name in SOURCES]
        words = [word for part in parts for word in ("-include", part)]
        with tempfile.TemporaryDirectory() as folder:
            probe = os.path.join(folder, "probe")
            built = subprocess.run([*compiler, *FLAGS, *words, HERE / "arithmetic_probe.cpp", "-o", probe],
                                   capture_output=True, text=True, check=False)
            if "-stdlib=libc++" in compiler and "file not found" in built.stderr:
                self.skipTest("libc++ is missing")
            self.assertEqual(built.returncode, 0, built.stderr)
            found = subprocess.run([*runner, probe], capture_output=True, text=True, check=True).stdout
        with open(HERE / "golden_arithmetic.txt", encoding="utf-8") as golden:
            self.assertEqual(found, golden.read())

    def test_gcc(self):
        self.compare(os.environ["DYNASURF_COMPILER"], "-O2")

    def test_clang(self):
        self.compare("clang++", "-O2")

    def test_clang_with_its_own_library(self):
        self.compare("clang++-19", "-stdlib=libc++", "-fexperimental-library", "-O1")

    def test_64_bit_arm(self):
        self.compare("aarch64-linux-gnu-g++", "-O2", runner=("qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"))

    def test_the_oldest_64_bit_pc(self):
        self.compare("g++", "-O1", runner=("qemu-x86_64", "-cpu", "qemu64"))


if __name__ == "__main__":
    unittest.main()
