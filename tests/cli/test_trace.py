"""--trace, and the tool that reads it."""

import pathlib
import subprocess
import sys
import unittest
import xml.etree.ElementTree

from cli import CliTest, hashes, run, small_patient


class Trace(CliTest):
    tool = pathlib.Path(__file__).parents[2] / "tools/time_line.py"

    def read(self, *arguments):
        done = subprocess.run([sys.executable, self.tool, *map(str, arguments)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return {line[:28].strip(): [float(number) for number in line[28:].split()] for line in done.stdout.splitlines()[1:]}

    def trace(self, name, *arguments):
        done = run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--no-timings", "--quiet",
                   "--trace", self.folder / name, *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.folder / name

    def test_tells_where_the_time_went_and_changes_no_result(self):
        run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "plain", "--no-timings", "--quiet")
        trace = self.trace("trace.json")
        self.assertEqual(hashes(self.folder / "plain"), hashes(self.folder / "r"))
        stages = {event["name"] for event in self.read_json(trace)["traceEvents"] if event["cat"] == "stage"}
        self.assertLessEqual({"read", "locate", "edges", "labels", "field", "surfaces", "fit", "fit: normal matrix",
                              "measures", "write", "publish"}, stages)
        picture = self.folder / "line.svg"
        table = self.read(trace, "--svg", picture)
        total, _ = table.pop("all")
        self.assertAlmostEqual(sum(ms for ms, _ in table.values()), total, delta=0.06 * total)
        self.assertTrue(all(0 < busy < 64 for _, busy in table.values()), table)
        self.assertEqual(xml.etree.ElementTree.parse(picture).getroot().tag, "{http://www.w3.org/2000/svg}svg")

    def test_tells_what_more_threads_would_take(self):
        trace = self.trace("one.json", "--threads", "1")
        table = self.read(trace, "--threads", "1,2,64")
        total, one, two, many = table["all"]
        self.assertAlmostEqual(one, total, delta=0.01 * total)
        self.assertLess(two, 0.9 * total)
        self.assertLess(many, two)
        self.assertTrue(all(total >= two >= total / 2 - 0.1 for total, _, two, _ in table.values()), table)

    def test_is_refused_where_it_cannot_be_written(self):
        inside = self.folder / "r" / "trace.json"
        self.refuses(1, "ventricle", small_patient() / "study.dcm", "--out", f"{self.folder}/r/", "--trace", inside,
                     says=(f"--trace {inside}", "lies in --out", "expected a place beside it"))
        self.assertFalse((self.folder / "r").exists())
        self.refuses(1, "batch", self.folder, "--out", self.folder / "cohort", "--", "--trace", "t.json",
                     says="--trace behind --")

    def test_writes_over_no_file(self):
        mine = self.folder / "mine.txt"
        mine.write_text("mine")
        done = run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--trace", mine)
        self.assertEqual((done.returncode, mine.read_text()), (2, "mine"), done.stderr)
        self.assertFalse((self.folder / "r").exists())


if __name__ == "__main__":
    unittest.main()
