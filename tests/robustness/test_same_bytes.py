"""The same bytes from processors, libraries and settings that this machine can imitate."""

import os
import subprocess
import sys
import unittest

from cli import CliTest, SMALL_PATIENT, hashes, run

PROBE = os.environ["DYNASURF_PROBE"]
GOLDEN = os.path.join(os.path.dirname(os.path.abspath(__file__)), "golden_bytes.txt")
# An older processor, for the C library: it then rounds its own functions in another way.
OLD = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX2,-FMA,-FMA4"}
LOCALE = "de_DE.UTF-8"  # with commas in numbers; as good as C where it is not installed
JUDGE = """
import math
print([(math.exp(x / 7), math.sin(x / 7), math.pow(x / 7, 1.3), math.atan2(x, 3)) for x in range(1, 3000)])
"""


def environment(**changes):
    return {**os.environ, **changes}


class SameBytes(CliTest):
    def jobs(self, name, env, threads):
        """Phantom, ventricle and cloud from the same words, in a folder of their own: what they leave."""
        folder = self.folder / name
        folder.mkdir()
        scan = ["--set", "points=4000", "--set", "noise_percent=0.5"]
        for words in (["phantom", "patient", "--seed", 7, "--out", "patient", *SMALL_PATIENT],
                      ["ventricle", "patient/study.dcm", "--out", "result", "--no-timings"],
                      ["ventricle", "patient/study.dcm", "--out", "thesis", "--preset", "thesis", "--no-timings"],
                      ["phantom", "cloud", "--out", "scan", *scan],
                      ["cloud", "scan/cloud.ply", "--out", "cloud", "--triangles", "640,160", "--no-timings"]):
            done = run(*words, "--threads", threads, cwd=folder, env=env)
            self.assertEqual(done.returncode, 0, f"{words}: {done.stdout}{done.stderr}")
        return hashes(folder)

    def test_on_an_older_processor_with_other_threads_and_another_locale(self):
        expected = self.jobs("here", environment(LC_ALL="C"), 1)
        self.assertGreater(len(expected), 10)
        self.assertEqual(self.jobs("there", environment(LC_ALL=LOCALE, **OLD), 7), expected)

    def test_the_older_processor_is_one_that_would_show(self):
        """The C library itself answers otherwise there, or the test above would prove nothing."""
        new, old = (subprocess.run([sys.executable, "-c", JUDGE], capture_output=True, text=True, check=True, env=env).stdout
                    for env in (environment(), environment(**OLD)))
        if new == old:
            self.skipTest("the C library of this machine rounds its functions in one way only")


class Probe(unittest.TestCase):
    """bytes_probe.cpp prints one number for each step of the libraries. The same everywhere, whatever compiled them."""

    def lines(self, *arguments, env=None):
        done = subprocess.run([PROBE, *arguments], capture_output=True, text=True, env=env, check=True, timeout=600)
        return done.stdout.splitlines()

    def test_has_its_golden_numbers(self):
        with open(GOLDEN, encoding="utf-8") as file:
            self.assertEqual(self.lines(), file.read().splitlines())

    def test_with_vectors_of_any_width_one_thread_and_small_caches(self):
        expected = self.lines()
        for widest, cache in (("4", "4096"), ("8", "65536")):
            self.assertEqual(self.lines(widest, "1", cache, env=environment(**OLD)), expected, widest)


if __name__ == "__main__":
    unittest.main()
