"""Configuring ends well whatever optional thing is missing or installed by half. Nothing is compiled.

What is half installed stands in a folder of its own, before everything else on the search paths.
"""

import os
import pathlib
import stat
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIBRARY_ALONE = ["-DDYNASURF_BUILD_APP=OFF", "-DDYNASURF_BUILD_TESTS=OFF"]


def hidden(*packages):
    return [f"-DCMAKE_DISABLE_FIND_PACKAGE_{package}=ON" for package in packages]


class Configure(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="dynasurf-configure-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.half = self.folder / "half"

    def write(self, path, text=""):
        file = self.half / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        return file

    def write_program(self, name, code):
        file = self.write(f"bin/{name}", f"#!/bin/sh\n{code}\n")
        file.chmod(file.stat().st_mode | stat.S_IXUSR)

    def configure(self, *settings):
        environment = {**os.environ, "PATH": f"{self.half / 'bin'}:{os.environ['PATH']}"}
        done = subprocess.run(["cmake", "-S", ROOT, "-B", self.folder / "build", f"-DCMAKE_PREFIX_PATH={self.half}",
                               "-DCMAKE_BUILD_TYPE=Release", "--no-warn-unused-cli", *settings],
                              capture_output=True, text=True, env=environment, stdin=subprocess.DEVNULL)
        self.said = done.stdout + done.stderr
        return done.returncode

    def configures(self, *settings):
        self.assertEqual(self.configure(*settings), 0, getattr(self, "said", ""))

    def break_itk(self):
        # As it is without the packages that ITK itself needs.
        self.write("lib/cmake/ITK-5.3/ITKConfig.cmake", "find_package(TheHalfThatIsMissing REQUIRED)\n")

    def break_mpi(self):
        # The programs of openmpi-bin, without the headers of libopenmpi-dev.
        for name in ("mpicc", "mpicxx", "mpic++", "mpiexec"):
            self.write_program(name, 'echo "cannot open the wrapper data file" >&2; exit 1')

    def break_node(self):
        for name in ("node", "nodejs", "npm"):
            self.write_program(name, "exit 127")

    def test_with_half_of_itk_hypre_mpi_and_node(self):
        self.break_itk()
        self.break_mpi()
        self.break_node()
        self.write("include/hypre/HYPRE_struct_ls.h")
        self.configures("-DDYNASURF_WITH_PAGES=OFF")
        self.assertIn("ITK is not usable here", self.said)
        # It is not asked again and again.
        self.configures("-DDYNASURF_WITH_PAGES=OFF")
        self.assertNotIn("ITK is not usable here", self.said)

    def test_with_hypre_but_half_of_mpi(self):
        self.break_mpi()
        self.write("include/hypre/HYPRE_struct_ls.h")
        self.write("lib/libHYPRE.so")
        self.write("lib/cmake/MPI/MPIConfig.cmake", 'message(FATAL_ERROR "half")\n')
        self.configures("-DDYNASURF_WITH_PAGES=OFF", "-DCMAKE_FIND_PACKAGE_PREFER_CONFIG=ON", *hidden("ITK"))

    def test_the_program_without_dicom_pages_and_python(self):
        self.break_node()
        self.configures("-DDYNASURF_BUILD_TESTS=OFF", "-DDYNASURF_WITH_DICOM=OFF", "-DDYNASURF_WITH_PAGES=OFF",
                        *hidden("DCMTK", "GTest", "Python3", "ITK", "benchmark"))
        self.assertIn("no manual pages", self.said)

    def test_the_libraries_without_what_the_program_and_the_tests_need(self):
        self.break_node()
        self.configures("-DDYNASURF_WITH_DICOM=OFF", "-DDYNASURF_WITH_PAGES=OFF", *LIBRARY_ALONE,
                        *hidden("DCMTK", "CLI11", "GTest", "Python3", "ITK", "benchmark"))

    def test_the_tests_leave_out_what_they_cannot_run(self):
        self.configures("-DDYNASURF_WITH_PAGES=OFF", *hidden("Python3", "ITK"))
        self.assertIn("Python 3 was not found", self.said)
        self.configures("-DDYNASURF_WITH_PAGES=OFF", "-DDYNASURF_WITH_DICOM=OFF", *hidden("DCMTK", "ITK"))
        self.assertIn("they are left out", self.said)

    def test_says_which_option_does_without_what_is_missing(self):
        for package, option in (("DCMTK", "DYNASURF_WITH_DICOM"), ("CLI11", "DYNASURF_BUILD_APP")):
            self.assertNotEqual(self.configure("--fresh", "-DDYNASURF_WITH_PAGES=OFF", *hidden(package)), 0)
            self.assertIn(f"{option}=OFF", " ".join(self.said.split()))


if __name__ == "__main__":
    unittest.main()
