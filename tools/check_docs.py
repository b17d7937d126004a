#!/usr/bin/env python3
"""Checks the documents: links lead somewhere, option tables are those of the program, nothing is left unfinished.

    check_docs.py [--program build/release/bin/dynasurf] [--update]

docs/api.md must be what api_page.py writes. A table of options stands between <!-- dynasurf options SUBJECT... --> and <!-- end -->; --update writes it anew.
"""

import argparse
import pathlib
import re
import subprocess
import sys
import urllib.parse

import api_page

ROOT = pathlib.Path(__file__).resolve().parent.parent
SKIP = {"build", "demo", "node_modules", "dist", ".git", ".cache"}
UNFINISHED = re.compile(r"\b(TO" + r"DO|FIX" + r"ME|XX" + r"X|TB" + r"D)\b|lorem " + "ipsum", re.IGNORECASE)
TEXTS = {".cpp", ".hpp", ".md", ".py", ".ts", ".cmake", ".json", ".html", ".css", ".mjs", ".cff", ".txt", ""}
TABLE = re.compile(r"(<!-- dynasurf options ([a-z ]+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)


def files(root):
    for path in sorted(root.rglob("*")):
        parts = path.relative_to(root).parts
        if path.is_file() and not SKIP & set(parts):
            yield path


def anchors_of(text):
    """GitHub's names of the headings of a document."""
    names = set()
    for heading in re.findall(r"^#+ (.+)$", text, re.MULTILINE):
        plain = re.sub(r"[^\w\- ]", "", re.sub(r"`", "", heading).lower()).strip()
        names.add(plain.replace(" ", "-"))
    return names


def broken_links(path, root):
    text = re.sub(r"```.*?```", "", path.read_text(), flags=re.DOTALL)
    for target in re.findall(r"\[[^\]]*\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+:", target):
            continue
        file, _, anchor = urllib.parse.unquote(target).partition("#")
        there = (path.parent / file).resolve() if file else path
        if not there.exists() or root not in [there, *there.parents]:
            yield f"{path.relative_to(root)}: the link {target} leads nowhere"
        elif anchor and there.suffix == ".md" and anchor not in anchors_of(there.read_text()):
            yield f"{path.relative_to(root)}: {file or path.name} has no heading #{anchor}"


def option_tables(path, root, program, update):
    text = path.read_text()

    def fresh(match):
        command = [str(program), "options", *match[2].split(), "--markdown"]
        return match[1] + subprocess.run(command, check=True, capture_output=True, text=True).stdout + match[4]

    written = TABLE.sub(fresh, text)
    if written != text:
        if update:
            path.write_text(written)
        else:
            yield f"{path.relative_to(root)}: a table of options is out of date; run tools/check_docs.py --update"


def api(root, update):
    path = root / "docs" / "api.md"
    if not path.exists():
        return
    fresh = api_page.page(root)
    if path.read_text() != fresh:
        if update:
            path.write_text(fresh)
        else:
            yield "docs/api.md: out of date; run tools/check_docs.py --update"


def unfinished(path, root):
    if path.suffix not in TEXTS or path.name == "package-lock.json" or path.name == "LICENSE":
        return
    try:
        lines = path.read_text().splitlines()
    except UnicodeDecodeError:
        return
    for number, line in enumerate(lines, 1):
        if UNFINISHED.search(line):
            yield f"{path.relative_to(root)}:{number}: unfinished: {line.strip()[:80]}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/bin/dynasurf")
    parser.add_argument("--update", action="store_true")
    parser.add_argument("--root", type=pathlib.Path, default=ROOT)
    arguments = parser.parse_args()
    root = arguments.root.resolve()
    failures, documents = list(api(root, arguments.update)), 0
    for path in files(root):
        failures += unfinished(path, root)
        if path.suffix == ".md":
            documents += 1
            failures += broken_links(path, root)
            failures += option_tables(path, root, arguments.program, arguments.update)
    print("\n".join(failures) if failures else f"{documents} documents are in order")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
