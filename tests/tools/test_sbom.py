"""A fresh bill of materials agrees with dpkg and package-lock.json, and tools/check_sbom.py finds what does not."""

import copy
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ["DYNASURF_PROGRAM"]
PACKAGES = "libeigen3-dev,libtbb-dev,zlib1g-dev"


@unittest.skipUnless(shutil.which("dpkg-query"), "this is no Debian")
class Sbom(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.file = pathlib.Path(folder.name) / "sbom.spdx.json"
        cls.run_tool("sbom.py", cls.file)
        cls.document = json.loads(cls.file.read_text())

    @staticmethod
    def run_tool(tool, file):
        done = subprocess.run([sys.executable, ROOT / "tools" / tool, "--program", PROGRAM, "--packages", PACKAGES, file],
                              capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr

    def check(self, change=lambda packages: None):
        changed = copy.deepcopy(self.document)
        change({package["SPDXID"]: package for package in changed["packages"]})
        changed["packages"] = [package for package in changed["packages"] if package["name"] != "removed"]
        file = self.file.with_name("changed.json")
        file.write_text(json.dumps(changed))
        return self.run_tool("check_sbom.py", file)

    def test_a_fresh_one_is_in_order(self):
        code, text = self.check()
        self.assertEqual(code, 0, text)
        names = {package["name"] for package in self.document["packages"]}
        self.assertLessEqual({"dynasurf", "libc6", "libtbb12", "libeigen3-dev", "three", "esbuild"}, names)

    def test_finds_every_difference(self):
        def set_to(element, **values):
            return lambda packages: packages[element].update(values)
        wrong = "0" * 128
        for change, says in ((set_to("SPDXRef-deb-libc6", versionInfo="1.0"), "libc6: version 1.0"),
                             (set_to("SPDXRef-deb-zlib1g", licenseDeclared="MIT"), "zlib1g: licence"),
                             (set_to("SPDXRef-npm-three", versionInfo="1.0"), "three: version 1.0"),
                             (set_to("SPDXRef-npm-three", checksums=[{"algorithm": "SHA512", "checksumValue": wrong}]),
                              "three: checksum"),
                             (set_to("SPDXRef-npm-esbuild", name="removed"), "leads nowhere"),
                             (set_to("SPDXRef-deb-libtbb12", SPDXID="SPDXRef-deb-other"), "without a relationship"),
                             (set_to("SPDXRef-dynasurf", versionInfo="9.9"), "CMakeLists.txt says")):
            code, text = self.check(change)
            self.assertEqual(code, 1, says)
            self.assertIn(says, text)

    def test_finds_what_is_missing_or_too_much(self):
        def without(name):
            document = copy.deepcopy(self.document)
            document["packages"] = [package for package in document["packages"] if package["SPDXID"] != name]
            document["relationships"] = [ends for ends in document["relationships"]
                                         if name not in (ends["spdxElementId"], ends["relatedSpdxElement"])]
            return document
        for name, says in (("SPDXRef-deb-libc6", "libc6: missing as RUNTIME_DEPENDENCY_OF"),
                           ("SPDXRef-deb-libeigen3-dev", "libeigen3-dev: missing as BUILD_DEPENDENCY_OF"),
                           ("SPDXRef-npm-three", "three: missing, but in package-lock.json")):
            file = self.file.with_name("short.json")
            file.write_text(json.dumps(without(name)))
            code, text = self.run_tool("check_sbom.py", file)
            self.assertEqual(code, 1)
            self.assertIn(says, text)
        done = subprocess.run([sys.executable, ROOT / "tools/check_sbom.py", "--packages", "zlib1g-dev", self.file],
                              capture_output=True, text=True)
        self.assertIn("libtbb-dev: listed as BUILD_DEPENDENCY_OF, which it is not", done.stdout)


if __name__ == "__main__":
    unittest.main()
