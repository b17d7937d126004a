"""The library from outside: installed and found by CMake or pkg-config, and taken in as sources.

DYNASURF_BUILD is the build that is installed, DYNASURF_SOURCE the sources.
"""

import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

BUILD, SOURCE = pathlib.Path(os.environ["DYNASURF_BUILD"]), pathlib.Path(os.environ["DYNASURF_SOURCE"])
HERE = pathlib.Path(__file__).resolve().parent


def run(*command, **more):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **more)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="dynasurf-package-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        first, cls.prefix = cls.folder / "first", cls.folder / "prefix"
        run("cmake", "--install", BUILD, "--prefix", first)
        first.rename(cls.prefix)  # nothing may remember where it was first

    def build(self, name, *options):
        build = self.folder / name
        launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
        run("cmake", "-S", HERE / name, "-B", build, "-G", "Ninja", *launcher, *options)
        return build

    def test_programs_find_the_installed_library(self):
        build = self.build("installed", f"-DCMAKE_PREFIX_PATH={self.prefix}", f"-DEXAMPLES={SOURCE / 'examples'}")
        run("cmake", "--build", build)
        self.assertEqual(run(build / "flow"), "1728 vectors\n")
        program = self.prefix / "bin" / "dynasurf"
        run(program, "phantom", "patient", "--set", "gates=4", "--out", self.folder / "patient")
        self.assertRegex(run(build / "study", self.folder / "patient/study.dcm", self.folder / "heart"), r"^EF \d+ % ")
        self.assertTrue((self.folder / "heart" / "report.html").is_file())
        run(program, "phantom", "cloud", "--set", "points=3000", "--out", self.folder / "scan")
        self.assertIn("320 triangles, watertight", run(build / "scan", self.folder / "scan/cloud.ply", self.folder / "body"))

    def test_installs_what_a_user_needs_and_no_more(self):
        files = {str(path.relative_to(self.prefix)) for path in self.prefix.rglob("*") if path.is_file()}
        needed = (r"bin/dynasurf", r"lib(/[^/]+)?/libdynasurf_[a-z_]+\.a", r"include/dynasurf/.+\.hpp",
                  r"lib(/[^/]+)?/cmake/dynasurf/dynasurf[A-Za-z-]+\.cmake", r"lib(/[^/]+)?/pkgconfig/dynasurf\.pc")
        where_made = (r"share/man/man1/dynasurf(-[a-z]+)?\.1\.gz", r"share/bash-completion/completions/dynasurf",
                      r"share/zsh/vendor-completions/_dynasurf",
                      r"lib/python3/dist-packages/dynasurf/(py\.typed|[a-z_]+\.pyi?|[a-z_]+\.[^/]+\.so)",
                      r"lib/python3/dist-packages/dynasurf-[0-9.]+\.dist-info/[A-Za-z_]+", r"share/doc/(lib)?dynasurf(-dev)?/[A-Za-z.]+")
        for kind in needed:
            self.assertTrue(any(re.fullmatch(kind, file) for file in files), kind)
        kinds = needed + where_made
        self.assertEqual([file for file in files if not any(re.fullmatch(kind, file) for kind in kinds)], [])

    def test_names_no_folder_of_the_build(self):
        texts = [path for ending in ("*.cmake", "*.pc") for path in self.prefix.rglob(ending)]
        self.assertGreaterEqual(len(texts), 4)
        for path in texts:
            for folder in (SOURCE, BUILD, self.folder):
                self.assertNotIn(str(folder), path.read_text(), path)

    def test_another_version_is_not_taken(self):
        wrong = self.folder / "wrong"
        wrong.mkdir()
        (wrong / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(w C CXX)\n"
                                              "find_package(dynasurf 0.3 REQUIRED)\n")
        done = subprocess.run(["cmake", "-S", wrong, "-B", wrong / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}"],
                              capture_output=True, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("0.2.0", done.stderr)

    @unittest.skipUnless(shutil.which("pkg-config"), "pkg-config is not installed")
    def test_pkg_config_tells_the_flags(self):
        paths = {**os.environ, "PKG_CONFIG_PATH": str(next(self.prefix.rglob("pkgconfig")))}
        flags = run("pkg-config", "--cflags", "--libs", "dynasurf", env=paths).split()
        run("c++", HERE / "subproject" / "grid.cpp", "-o", self.folder / "grid", *flags)
        self.assertEqual(run(self.folder / "grid"), "24 voxels\n")

    def test_the_sources_are_a_part_of_another_project(self):
        build = self.build("subproject", f"-DDYNASURF={SOURCE}")
        run("cmake", "--build", build, "--target", "grid")
        self.assertEqual(run(build / "grid"), "24 voxels\n")


if __name__ == "__main__":
    unittest.main()
