#!/usr/bin/env python3
"""Prints a Markdown file as Doxygen wants it: headings with names, links to pages and headings by these names.

    site_page.py FILE

docs/Doxyfile calls it for every page. On GitHub a link names a file and a heading; Doxygen knows neither. A heading gets
the name that `reference` makes of its file and of GitHub's name for it. Other files are linked where they lie.
"""

import os
import pathlib
import re
import sys
import urllib.parse

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from check_docs import ROOT, anchor_of  # pylint: disable=wrong-import-position

SITE = ROOT / "build" / "docs"
CODE = re.compile(r"```.*?```|^(?: {4}[^\n]*\n)+|`[^`\n]*`", re.DOTALL | re.MULTILINE)
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")


def reference(path, anchor=""):
    name = re.sub(r"\W", "_", str(path.relative_to(ROOT).with_suffix("")))
    return f"{name}__{re.sub(r'[^a-z0-9]', '_', anchor)}" if anchor else name


def heading(match, path, seen):
    name = reference(path, anchor_of(match[2]) if seen else "")
    seen.append(name)
    return f"{match[1]} {match[2]} {{#{name}}}"


def link(match, path):
    picture, text, target = match.groups()
    if re.match(r"[a-z]+:", target):
        return match[0]
    file, _, anchor = urllib.parse.unquote(target).partition("#")
    there = (path.parent / file).resolve() if file else path
    if picture:
        return f"![{text}]({there.relative_to(ROOT)})"
    if there.suffix == ".md":
        return f"[{text}](@ref {reference(there, anchor)})"
    return f'<a href="{os.path.relpath(there, SITE)}">{text}</a>'


def page(path):
    text, seen = re.sub(r"<!--.*?-->\n?", "", path.read_text(), flags=re.DOTALL), []
    text = re.sub(r"^(#+) (.+?)$", lambda match: heading(match, path, seen), text, flags=re.MULTILINE)
    parts, end = [], 0
    for code in CODE.finditer(text):
        parts += [LINK.sub(lambda match: link(match, path), text[end:code.start()]), code[0]]
        end = code.end()
    return "".join(parts) + LINK.sub(lambda match: link(match, path), text[end:])


if __name__ == "__main__":
    sys.stdout.write(page(pathlib.Path(sys.argv[1]).resolve()))
