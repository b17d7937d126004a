"""What the tests of the command line share. The program is named by the environment variable DYNASURF_PROGRAM."""

import atexit
import functools
import gzip
import hashlib
import json
import os
import pathlib
import shutil
import struct
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["DYNASURF_PROGRAM"]
KINDS = "hebron, mayo, partial, spheres, sphere, gap, cycle, pathology, patient, organ"

# Small and quick, yet a heart: 4 gates on a coarse lattice.
SMALL_PATIENT = ["--set", "gates=4", "--set", "lattice.nx=40", "--set", "lattice.ny=40", "--set", "lattice.dx_mm=4",
                 "--set", "lattice.dy_mm=4", "--set", "fwhm_mm=10"]
# For campaigns, which run it thousands of times.
TINY_PATIENT = ["--set", "gates=4", "--set", "lattice.nx=20", "--set", "lattice.ny=20", "--set", "lattice.dx_mm=8",
                "--set", "lattice.dy_mm=8", "--set", "fwhm_mm=12"]
# For tests that any result will do for: without the fit it comes in half the time.
EDGES = ["--preset", "edges"]


def run(*arguments, **options):
    options.setdefault("stdin", subprocess.DEVNULL)
    options.setdefault("timeout", 120)
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output="stdout" not in options, text=True, **options)


def hashes(folder):
    """File name -> SHA-256 of all files below a folder."""
    folder = pathlib.Path(folder)
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(folder.rglob("*")) if path.is_file()}


@functools.cache
def shared_folder():
    """Lives as long as the process: phantoms and results that several tests look at."""
    folder = tempfile.mkdtemp(prefix="dynasurf-cli-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return pathlib.Path(folder)


@functools.cache
def small_patient():
    folder = shared_folder() / "patient"
    made = run("phantom", "patient", "--seed", 7, "--out", folder, *SMALL_PATIENT)
    assert made.returncode == 0, made.stderr
    return folder


@functools.cache
def small_result():
    folder = shared_folder() / "result"
    made = run("ventricle", small_patient() / "study.dcm", "--out", folder)
    assert made.returncode == 0, made.stdout + made.stderr
    return folder


def write_mask(study, path, covers):
    """A NIfTI mask for a NIfTI study: 1 in the columns and rows for which `covers(i, j)` holds, in all slices."""
    volume = bytearray(gzip.decompress(study.read_bytes()))
    nx, ny, nz = struct.unpack_from("<3h", volume, 42)
    struct.pack_into("<2h", volume, 40, 3, nx)
    struct.pack_into("<h", volume, 48, 1)
    plane = struct.pack(f"<{nx * ny}f", *(float(covers(i, j)) for j in range(ny) for i in range(nx)))
    path.write_bytes(bytes(volume[:352]) + plane * nz)


class CliTest(unittest.TestCase):
    maxDiff = 4000

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="dynasurf-cli-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def refuses(self, code, *arguments, says=(), **options):
        """The program ends with `code` and exactly one line on standard error that holds every text of `says`."""
        done = run(*arguments, **options)
        self.assertEqual(done.returncode, code, done.stderr)
        lines = [line for line in done.stderr.splitlines() if not line.endswith(tuple("0123456789"))
                 or line.startswith("dynasurf: error: ")]
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertTrue(lines[0].startswith("dynasurf: error: "), lines[0])
        for text in [says] if isinstance(says, str) else says:
            self.assertIn(text, lines[0])
        return lines[0]

    def read_json(self, path):
        return json.loads(pathlib.Path(path).read_text())
