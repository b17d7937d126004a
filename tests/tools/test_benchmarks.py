"""tools/compare_benchmarks.py finds what became slower, and nothing else; tools/benchmark_table.py sets peers beside ours."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"


def row(name, time, unit="ms", **more):
    return {"name": name, "run_type": "iteration", "real_time": time, "time_unit": unit, **more}


def run(tool, *words):
    done = subprocess.run([sys.executable, TOOLS / tool, *words], capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


class Benchmarks(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_of(self, name, *rows):
        folder = self.folder / name
        folder.mkdir()
        context = {"host_name": "one", "num_cpus": 2}
        (folder / "field_bench.json").write_text(json.dumps({"context": context, "benchmarks": rows}))
        return folder

    def compare(self, *words):
        return run("compare_benchmarks.py", *words)

    def test_passes_what_is_as_fast(self):
        old = self.run_of("old", row("steady", 1.0), row("gone", 3.0))
        new = self.run_of("new", row("steady", 1090.0, "us"), row("added", 3.0))
        code, text = self.compare(old, new)
        self.assertEqual(code, 0, text)
        self.assertIn("1.09", text)
        self.assertIn("field_bench: gone: only in the old run", text)
        self.assertIn("field_bench: added: only in the new run", text)

    def test_fails_on_a_loss(self):
        old, new = self.run_of("old", row("steady", 1.0)), self.run_of("new", row("steady", 1.2))
        code, text = self.compare(old, new)
        self.assertEqual(code, 1, text)
        self.assertIn("slower", text)
        self.assertEqual(self.compare(old, new, "--loss", "25")[0], 0)

    def test_takes_the_fastest_of_repetitions_and_no_means(self):
        old = self.run_of("old", row("steady", 1.0))
        new = self.run_of("new", row("steady", 9.0), row("steady", 1.0), row("steady", 5.0, run_type="aggregate"))
        self.assertEqual(self.compare(old, new)[0], 0)

    def test_refuses_what_cannot_be_compared(self):
        old, other = self.run_of("old", row("steady", 1.0)), self.run_of("other", row("band", 1.0))
        (self.folder / "empty").mkdir()
        (self.folder / "torn.json").write_text('{"benchmarks": [')
        for new, says in ((other, "no benchmark in common"), (self.folder / "empty", "holds no *.json"),
                          (self.folder / "torn.json", "torn.json"), (self.folder / "absent.json", "absent.json")):
            code, text = self.compare(old, new)
            self.assertEqual(code, 2, text)
            self.assertIn(says, text)

    def test_the_table_sets_peers_beside_ours(self):
        results = self.run_of("results", row("steady/size:62/threads:1/digits:3/process_time/real_time", 2.0),
                              row("steady/size:62/threads:1/digits:3/process_time/real_time", 3.0),
                              row("hypre/size:62/process_time/real_time", 100000.0, "us"),
                              row("itk_steps/size:62/threads:1/process_time/real_time", 30.0, steps=5),
                              row("hypre/size:128/process_time/real_time", 9.0))
        code, text = run("benchmark_table.py", results)
        self.assertEqual(code, 0, text)
        lines = [line.split() for line in text.splitlines()[2:]]
        self.assertEqual([line[-2:] for line in lines], [["2", "ms"], ["ms", "3x"], ["ms", "50x"]], text)
        self.assertEqual(run("benchmark_table.py", self.folder)[0], 2)


if __name__ == "__main__":
    unittest.main()
