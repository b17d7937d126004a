"""`dynasurf view`: a result in the browser, a study in the page that is the program."""

import base64
import json
import os
import re
import stat
import time
import unittest
import zlib

from cli import CliTest, run, small_patient, small_result

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
        text = re.search(r'id="given">(.*?)</script>', out.read_text()).group(1)
        self.assertEqual(json.loads(json.loads(text)["options_json"]), self.read_json(small_result() / "options.json"))
        (self.folder / "wrong.json").write_text('{"mistake": 1}')
        self.refuses(1, *arguments, "--replace", "--options", self.folder / "wrong.json", says="mistake")
        self.refuses(1, "view", small_result(), "--options", small_result() / "options.json", says="is a result")

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
        self.assertEqual(done.stdout, f"open this page in a browser: {small_result() / 'report.html'}\n")

    def test_what_cannot_be_viewed_is_refused(self):
        os.environ["TMPDIR"] = str(self.folder)
        self.addCleanup(os.environ.pop, "TMPDIR")
        study = small_patient() / "study.dcm"
        other = self.folder / "other.html"
        other.write_text("<!doctype html><p>another page")
        self.refuses(2, "view", study, "--page", other, says="no place for files")
        self.refuses(2, "view", study, "--page", self.folder / "none.html", says="none.html")
        self.refuses(2, "view", self.folder / "nothing", "--page", self.page, says="nothing")
        self.refuses(1, "view", small_result(), "--out", self.folder / "x.html", says="is a result")
        self.assertFalse(list(self.folder.glob("dynasurf-view-*")), "a page was left")


if __name__ == "__main__":
    unittest.main()
