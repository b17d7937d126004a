"""`dynasurf view`: a result in the browser, a study in the page that is the program."""

import base64
import json
import os
import re
import shutil
import stat
import subprocess
import time
import unittest
import zlib

from cli import PROGRAM, CliTest, run, small_patient, small_result

PAGE = '<!doctype html><script type="application/json" id="given"></script><p>the page</p>'


class View(CliTest):
    def setUp(self):
        super().setUp()
        self.page = self.folder / "dynasurf.html"
        self.page.write_text(PAGE)
        # A browser that notes what it is given.
        self.seen = self.folder / "seen"
        bin = self.folder / "bin"
        bin.mkdir()
        opener = bin / "xdg-open"
        opener.write_text(f'#!/bin/sh\nprintf %s "$1" > {self.seen}.part && mv {self.seen}.part {self.seen}\n')
        opener.chmod(0o755)
        self.environment = {**os.environ, "PATH": f"{bin}:{os.environ['PATH']}", "TMPDIR": str(self.folder)}

    def opened(self):
        for _ in range(200):
            if self.seen.exists():
                return self.seen.read_text()
            time.sleep(0.05)
        self.fail("nothing was opened")

    def given(self, page):
        text = re.search(r'id="given">(.*?)</script>', page).group(1)
        self.assertNotIn("<", text)
        return {file["path"]: zlib.decompress(base64.b64decode(file["deflated"])) for file in json.loads(text)["files"]}

    def test_a_result_is_opened_as_it_is(self):
        done = run("view", small_result(), env=self.environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.opened(), str(small_result() / "report.html"))

    def test_a_result_that_lost_its_numbers_is_shown_too(self):
        result = self.folder / "result"
        shutil.copytree(small_result(), result)
        (result / "results.json").unlink()
        self.assertEqual(run("view", result, env=self.environment).returncode, 0)
        self.assertEqual(self.opened(), str(result / "report.html"))

    def test_a_study_stands_whole_in_a_page_that_only_its_owner_can_read(self):
        study = small_patient() / "study.dcm"
        done = run("view", study, "--page", self.page, env=self.environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        path = self.opened()
        self.assertIn(path, done.stdout)
        self.assertEqual(stat.S_IMODE(os.stat(os.path.dirname(path)).st_mode), 0o700)
        with open(path) as page:
            text = page.read()
        self.assertTrue(text.endswith("<p>the page</p>"))
        self.assertEqual(self.given(text), {"study.dcm": study.read_bytes()})

    def test_a_page_can_be_written_without_a_browser(self):
        out = self.folder / "with study.html"
        done = run("view", small_patient() / "study.nii.gz", "--page", self.page, "--out", out, env=self.environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.given(out.read_text()), {"study.nii.gz": (small_patient() / "study.nii.gz").read_bytes()})
        self.assertFalse(self.seen.exists())
        self.refuses(2, "view", small_patient() / "study.nii.gz", "--page", self.page, "--out", out, says="exists")

    def test_a_study_keeps_the_options_of_a_result(self):
        out = self.folder / "live.html"
        arguments = ("view", small_patient() / "study.dcm", "--page", self.page, "--out", out)
        done = run(*arguments, "--options", small_result() / "options.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        options = self.given(out.read_text())["options.json"]
        self.assertEqual(options, (small_result() / "options.json").read_bytes())
        (self.folder / "wrong.json").write_text('{"mistake": 1}')
        self.refuses(1, *arguments, "--replace", "--options", self.folder / "wrong.json", says="mistake")
        self.refuses(1, "view", small_result(), "--options", small_result() / "options.json", says="is a result")
        self.refuses(1, "view", small_result(), "--series", "1", says="is a result")

    def test_a_result_stands_in_the_page_with_its_study(self):
        out = self.folder / "live.html"
        study = small_patient() / "study.dcm"
        done = run("view", small_result(), "--study", study, "--page", self.page, "--out", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        files = self.given(out.read_text())
        self.assertEqual(files.pop("study.dcm"), study.read_bytes())
        name = small_result().name
        self.assertEqual(files, {f"{name}/{file.relative_to(small_result())}": file.read_bytes()
                                 for file in small_result().rglob("*") if file.is_file()})
        # Beside the result the study is found by what is in it.
        result = self.folder / "beside" / "result"
        shutil.copytree(small_result(), result)
        shutil.copy(study, self.folder / "beside" / "image")
        self.assertEqual(run("view", result, "--page", self.page, env=self.environment).returncode, 0)
        with open(self.opened()) as page:
            self.assertEqual(self.given(page.read())["image"], study.read_bytes())

    def test_the_wrong_study_or_none_is_told(self):
        result = self.folder / "alone" / "result"
        shutil.copytree(small_result(), result)
        wrong = self.folder / "wrong.dcm"
        wrong.write_bytes((small_patient() / "study.dcm").read_bytes()[:-1] + b"\1")
        self.refuses(2, "view", result, "--study", wrong, "--page", self.page, says="is not the study")
        self.refuses(2, "view", result, "--page", self.page, "--out", self.folder / "x.html", says="--study")
        self.refuses(1, "view", small_patient() / "study.dcm", "--study", wrong, "--page", self.page, says="is no result")
        self.assertFalse((self.folder / "x.html").exists())

    def test_a_run_leaves_a_page_that_can_be_run_again(self):
        program = self.folder / "installed" / "bin" / "dynasurf"
        program.parent.mkdir(parents=True)
        shutil.copy(PROGRAM, program)
        study = small_patient() / "study.nii.gz"
        words = [program, "ventricle", study, "--out", self.folder / "result", "--live", "--quiet"]
        missing = subprocess.run(words, stderr=subprocess.PIPE, text=True)
        self.assertEqual(missing.returncode, 2)
        self.assertIn("dynasurf.html is not installed", missing.stderr)
        page = self.folder / "installed" / "share" / "dynasurf" / "dynasurf.html"
        page.parent.mkdir(parents=True)
        shutil.copy(self.page, page)
        self.assertEqual(subprocess.run(words).returncode, 0)
        files = self.given((self.folder / "result" / "live.html").read_text())
        self.assertEqual(files["study.nii.gz"], study.read_bytes())
        for name in ("report.html", "results.json", "options.json"):
            self.assertEqual(files[f"result/{name}"], (self.folder / "result" / name).read_bytes())
        self.assertEqual(run("rerun", self.folder / "result", "--study", study).returncode, 0)

    def test_a_scan_is_taken_as_one(self):
        scan = self.folder / "scan.XYZ"
        scan.write_text("0 0 0\n1 0 0\n0 1 0\n")
        out = self.folder / "scan.html"
        done = run("view", scan, "--page", self.page, "--out", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.given(out.read_text()), {"scan.XYZ": scan.read_bytes()})

    def test_without_a_browser_the_page_is_named(self):
        done = run("view", small_result(), env={**os.environ, "PATH": str(self.folder)})
        self.assertEqual(done.returncode, 0, done.stderr)
        # Where dynasurf.html is beside the program, a line before tells that the study is not found.
        self.assertEqual(done.stdout.splitlines()[-1], f"open this page in a browser: {small_result() / 'report.html'}")

    def test_what_cannot_be_viewed_is_refused(self):
        os.environ["TMPDIR"] = str(self.folder)
        self.addCleanup(os.environ.pop, "TMPDIR")
        study = small_patient() / "study.dcm"
        other = self.folder / "other.html"
        other.write_text("<!doctype html><p>another page")
        self.refuses(2, "view", study, "--page", other, says="no place for files")
        self.refuses(2, "view", study, "--page", self.folder / "none.html", says="none.html")
        self.refuses(2, "view", self.folder / "nothing", "--page", self.page, says="nothing")
        self.assertFalse(list(self.folder.glob("dynasurf-view-*")), "a page was left")


if __name__ == "__main__":
    unittest.main()
