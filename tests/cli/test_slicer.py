"""The Slicer execution model: what Slicer reads of a command, and how it calls it."""

import pathlib
import re
import subprocess
import unittest
import xml.etree.ElementTree as xml

from cli import PROGRAM, CliTest, run

KINDS = {"integer", "double", "boolean", "string", "file", "directory", "integer-vector", "double-vector"}
HEAD = ["category", "title", "description", "version", "documentation-url", "license", "contributor", "acknowledgements"]
EXAMPLE = pathlib.Path(__file__).resolve().parents[2] / "examples/slicer/DynasurfVentricle"


def described(command):
    done = run(command, "--xml")
    assert done.returncode == 0, done.stderr
    return xml.fromstring(done.stdout)


def called_by_slicer(command, values, *more):
    """The words Slicer makes of its panel: every parameter, empty ones too, then those with an index."""
    flags, indexed = [], []
    for parameter in described(command).find("parameters"):
        name = parameter.findtext("name")
        if parameter.tag in ("label", "description"):
            continue
        if parameter.find("index") is not None:
            indexed.append(values[name])
        elif parameter.tag != "boolean":
            flags += ["--" + parameter.findtext("longflag"), str(values.get(name, ""))]
        elif values.get(name):
            flags.append("--" + parameter.findtext("longflag"))
    return run(command, *more, *flags, *indexed)


class Slicer(CliTest):
    def test_a_description_follows_the_grammar(self):
        for command in ("ventricle", "cloud"):
            root = described(command)
            self.assertEqual(root.tag, "executable")
            names = [child.tag for child in root]
            self.assertEqual(names[-1], "parameters")
            self.assertEqual(names[:-1], [n for n in HEAD if n in names])
            parameters = list(root.find("parameters"))
            self.assertEqual([p.tag for p in parameters[:2]], ["label", "description"])
            variables = []
            for parameter in parameters[2:]:
                self.assertIn(parameter.tag, KINDS)
                self.assertTrue((parameter.find("longflag") is None) != (parameter.find("index") is None))
                self.assertRegex(parameter.findtext("name"), r"^[A-Za-z_]\w*$")
                self.assertTrue(parameter.findtext("label") and parameter.findtext("description"))
                if parameter.tag in ("file", "directory"):
                    self.assertIn(parameter.findtext("channel"), ("input", "output"))
                variables.append(parameter.findtext("name"))
            self.assertEqual(len(variables), len(set(variables)))
            flags = {p.findtext("longflag") for p in parameters} - {None}
            told = set(re.findall(r"--([a-z][\w-]*)", run(command, "--help").stdout))
            self.assertLessEqual(flags, told)
            self.assertLessEqual({"out", "preset", "set", "options", "replace"}, flags)

    def test_slicers_call_gives_numbers_and_progress(self):
        out, returned = self.folder / "result", self.folder / "returned"
        study = self.folder / "patient"
        self.assertEqual(run("phantom", "patient", "--out", study, "--set", "gates=4", "--quiet").returncode, 0)
        done = called_by_slicer("ventricle", {"study": study / "study.dcm", "out": out, "preset": "edges", "no_timings": True},
                                "--returnparameterfile", returned)
        self.assertIn(done.returncode, (0, 3), done.stderr)
        results = self.read_json(out / "results.json")
        told = dict(line.split(" = ") for line in returned.read_text().splitlines())
        self.assertEqual(float(told["ef_percent"]), results["ef_percent"])
        tags = re.findall(r"<filter-[^\n]*", done.stdout)
        opened = [xml.fromstring(t).findtext("filter-name") for t in tags if t.startswith("<filter-start>")]
        ended = [xml.fromstring(t).findtext("filter-name") for t in tags if t.startswith("<filter-end>")]
        self.assertTrue(opened and opened == ended)
        parts = [float(xml.fromstring(t).text) for t in tags if t.startswith("<filter-progress>")]
        self.assertTrue(parts and min(parts) >= 0 and max(parts) == 1)
        plain = self.folder / "plain"
        run("ventricle", study / "study.dcm", "--out", plain, "--preset", "edges", "--no-timings", "--quiet")
        self.assertEqual((out / "results.json").read_bytes(), (plain / "results.json").read_bytes())

    def test_a_mistake_is_told_as_ever(self):
        self.assertEqual(run("ventricle", "s.dcm", "--out", "r", "--returnparameterfile").returncode, 1)
        self.assertEqual(run("info", "--xml").returncode, 1)
        self.assertEqual(run("info", "s.dcm", "--returnparameterfile", "f").returncode, 1)

    def test_the_example_is_a_module(self):
        done = subprocess.run([EXAMPLE, "--xml"], capture_output=True, text=True,
                              env={"PATH": f"{pathlib.Path(PROGRAM).parent}:/usr/bin:/bin"})
        self.assertEqual(xml.fromstring(done.stdout).tag, "executable", done.stderr)


if __name__ == "__main__":
    unittest.main()
