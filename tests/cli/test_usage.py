"""The way in: help, version, options, and what a wrong command line is told."""

import json
import subprocess
import unittest

from cli import KINDS, PROGRAM, CliTest, run


class Usage(CliTest):
    def test_version_names_version_commit_and_use(self):
        done = run("--version")
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stdout, r"^dynasurf \d+\.\d+\.\d+ \(commit [0-9a-z+]+\)\nResearch use only\.")

    def test_help_lists_the_commands_and_the_exit_codes(self):
        done = run("--help")
        self.assertEqual(done.returncode, 0)
        for word in ("ventricle", "info", "phantom", "measure", "options", "rerun", "Exit codes"):
            self.assertIn(word, done.stdout)

    def test_help_of_a_command_tells_its_arguments(self):
        done = run("ventricle", "--help")
        self.assertEqual(done.returncode, 0)
        for word in ("STUDY", "--out", "--preset", "--set", "--mesh-format", "--keep-stages", "--threads", "--series"):
            self.assertIn(word, done.stdout)

    def test_usage_lines_begin_with_the_program(self):
        self.assertIn("\nUsage: dynasurf [OPTIONS] SUBCOMMAND\n", run("--help").stdout)
        self.assertIn("\nUsage: dynasurf ventricle [OPTIONS] STUDY\n", run("ventricle", "--help").stdout)
        self.assertIn("\nUsage: dynasurf phantom [OPTIONS] KIND\n", run("phantom", "--help").stdout)
        self.assertIn("\nUsage: dynasurf perfusion [OPTIONS] SUBCOMMAND\n", run("perfusion", "--help").stdout)
        self.assertIn("\nUsage: dynasurf perfusion score [OPTIONS] RESULT\n", run("perfusion", "score", "--help").stdout)

    def test_wrong_command_lines_end_with_1(self):
        self.refuses(1, says="--help")
        self.refuses(1, "ventrikel", says="--help")
        for former, now in (("edges", "borders --edges-only"), ("normals", "perfusion build"), ("scores", "perfusion score"),
                            ("compare", "perfusion compare")):
            self.refuses(1, former, "a.dcm", says=f"'{former}' is '{now}' now")
        self.refuses(1, "perfusion", says="--help")
        self.refuses(1, "perfusion", "forget", says="--help")
        self.refuses(1, "ventricle", says="required")
        self.refuses(1, "ventricle", "a.dcm", "--out", self.folder / "r", "--fast", says="--fast")
        self.refuses(1, "ventricle", "a.dcm", "--out", self.folder / "r", "--threads", "many")
        self.refuses(1, "info", "a", "b")
        self.assertEqual(list(self.folder.iterdir()), [])


class Options(CliTest):
    def test_prints_the_manual(self):
        done = run("options")
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stdout, r"edges\.sigma_px \(canny\) +[0-9.]+ +px +0 to 20 +\w")

    def test_json_rows_can_be_set_again(self):
        rows = json.loads(run("options", "--json").stdout)
        self.assertGreater(len(rows), 40)
        for row in rows:
            self.assertTrue(row["meaning"], row["path"])
        settings = [part for row in rows for part in ("--set", f"{row['path']}={row['default']}")
                    if row["method"] in (None, "canny", "steady", "mlc", "automatic")]
        # All of them are understood: what is wrong is the study, not the usage.
        self.refuses(2, "ventricle", self.folder / "missing.dcm", "--out", self.folder / "r", *settings)

    def test_tells_the_values_of_a_file_and_of_settings_and_writes_them_as_a_file(self):
        chosen = ("--set", "edges=acc", "--set", "edges.tensor_sigma_px=4", "--set", "manual.axis=0,0,1")
        text = run("options", *chosen, "--as-file").stdout
        file = self.folder / "options.json"
        file.write_text(text)
        self.assertEqual(run("options", "--options", file, "--as-file").stdout, text)
        rows = {(row["path"], row["method"]): row["default"] for row in json.loads(run("options", "--options", file, "--json").stdout)}
        self.assertEqual(rows["edges", None], "acc")
        self.assertEqual(rows["edges.tensor_sigma_px", "acc"], "4")
        self.assertEqual(rows["manual.axis", None], "0,0,1")
        for subject in (("cloud",), ("organ",), ("phantom", "cloud"), ("phantom", "hebron")):
            file.write_text(run("options", *subject, "--as-file").stdout)
            self.assertEqual(run("options", *subject, "--options", file).stdout, run("options", *subject).stdout)
        file.write_text('{"mistake": 1}')
        self.refuses(1, "options", "--options", file, says=[str(file), "mistake"])
        self.refuses(1, "options", "--set", "mistake=1", says="mistake")

    def test_tells_the_options_of_every_phantom(self):
        for kind in KINDS.split(", "):
            done = run("options", "phantom", kind)
            self.assertEqual(done.returncode, 0, kind)
            self.assertIn("meaning", done.stdout)

    def test_tells_the_presets_apart(self):
        self.assertNotEqual(run("options").stdout, run("options", "--preset", "thesis").stdout)

    def test_refuses_unknown_subjects_with_the_choices(self):
        self.refuses(1, "options", "liver", says="choices: ventricle, cloud, organ, phantom KIND")
        self.refuses(1, "options", "phantom", "heberon", says=["did you mean 'hebron'?", KINDS])
        self.refuses(1, "options", "--preset", "fast", says="choices: psf_corrected, edges, thesis")


class Output(CliTest):
    def test_a_closed_pipe_is_told_and_ends_with_2(self):
        with subprocess.Popen([PROGRAM, "options"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as program:
            program.stdout.close()  # before anything was read
            error = program.stderr.read()
            # The table may fit into the pipe before it is closed; then nothing is wrong.
            self.assertIn((program.wait(), error.count("dynasurf: error: cannot write to standard output")),
                          [(2, 1), (0, 0)])

    def test_a_closed_standard_output_is_told_and_ends_with_2(self):
        for stream in (">&-", ">/dev/full"):
            done = subprocess.run(["bash", "-c", f'"$0" options {stream}', PROGRAM], stderr=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 2)
            self.assertIn("dynasurf: error: cannot write to standard output", done.stderr)

    def test_a_closed_standard_error_changes_nothing(self):
        done = subprocess.run(["bash", "-c", '"$0" options 2>&-', PROGRAM], stdout=subprocess.PIPE, text=True)
        self.assertEqual((done.returncode, done.stdout), (0, run("options").stdout))


if __name__ == "__main__":
    unittest.main()
