"""The page of `./dev thesis`: what experiments print becomes tables, and every published number has its place."""

import pathlib
import re
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "experiments/thesis"))

from page import Page, markdown_html, sections  # noqa: E402

PRINTED = """# Results

## Table 1

Said before.

| a | b |
|---|---|
| 1 < 2 | 3 |

## Table 2

   in columns      apart
     1.0            2.0
"""


class ThesisPage(unittest.TestCase):
    def test_tables_are_found_by_their_headings(self):
        self.assertEqual(list(sections(PRINTED)), ["Table 1", "Table 2"])
        self.assertIn("| 1 < 2 | 3 |", sections(PRINTED)["Table 1"])

    def test_markdown_becomes_html(self):
        text = markdown_html(sections(PRINTED)["Table 1"])
        self.assertIn("<p>Said before.</p>", text)
        self.assertIn("<tr><th>a</th><th>b</th></tr>", text)
        self.assertIn("<tr><td>1 &lt; 2</td><td>3</td></tr>", text)
        self.assertIn("<pre>     1.0            2.0</pre>", markdown_html("     1.0            2.0"))

    def test_a_page_holds_what_it_was_given(self):
        with tempfile.TemporaryDirectory() as folder:
            picture = pathlib.Path(folder) / "p.png"
            picture.write_bytes(b"\x89PNG")
            page = Page("stamp")
            page.chapter("Chapter 1")
            page.table("N1", "a table", "| a |\n|---|\n| 1 |", "It differs.")
            page.figure("a figure", picture, "dynasurf show x")
            for text in ("stamp", 'href="#chapter-1"', "N1: a table", "It differs.", "data:image/png;base64,iVBORw"):
                self.assertIn(text, page.html())
            self.assertIn("It differs.", "\n".join(page.text))
            self.assertNotIn("http", page.html().replace("<!DOCTYPE html>", ""))

    def test_every_published_table_has_a_place(self):
        source = (ROOT / "experiments/thesis/run.py").read_text()
        told = set(re.findall(r'"N(\d+)', source)) | {n for pair in re.findall(r'"N(\d+) and N(\d+)', source) for n in pair}
        self.assertEqual({str(n) for n in range(1, 24)} - told, set())


if __name__ == "__main__":
    unittest.main()
