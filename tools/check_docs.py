#!/usr/bin/env python3
"""Checks the documents: links lead somewhere, numbers are those that were measured, options are those of the program,
nothing is left unfinished, a line holds one sentence, and all of it stays short enough to be read.

    check_docs.py [--program build/release/bin/dynasurf] [--update]

Numbers from result files stand between the markers of tools/figures.py; --update writes them anew. A table row that
begins with `path.of.option` below the headline "option | default" must tell the program's default.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys
import urllib.parse

import figures

ROOT = pathlib.Path(__file__).resolve().parent.parent
SKIP = {"build", "demo", "node_modules", "dist", ".git", ".cache"}
UNFINISHED = re.compile(r"\b(TO" + r"DO|FIX" + r"ME|XX" + r"X|TB" + r"D)\b|lorem " + "ipsum", re.IGNORECASE)
TEXTS = {".cpp", ".hpp", ".md", ".py", ".ts", ".cmake", ".json", ".html", ".css", ".mjs", ".cff", ".txt", ""}
# The end of a sentence with another one behind it; run-in headings, code, brackets and abbreviations are none.
NO_SENTENCE = re.compile(r"\*\*.*?\*\*|`[^`]*`|\([^()]*\)|\b(?:eqs?|figs?|app|ch|cf|al)\.")
TWO_SENTENCES = re.compile(r"[a-z0-9%]{2}[.!?] [A-Z]")
# All documents together as they are read: without comments.
COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
LARGEST_BYTES = 180_000


def files(root):
    for path in sorted(root.rglob("*")):
        parts = path.relative_to(root).parts
        if path.is_file() and not SKIP & set(parts):
            yield path


def anchor_of(heading):
    """GitHub's name of a heading."""
    return re.sub(r"[^\w\- ]", "", heading.replace("`", "").lower()).strip().replace(" ", "-")


def anchors_of(text):
    return {anchor_of(heading) for heading in re.findall(r"^#+ (.+)$", text, re.MULTILINE)}


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


def defaults_of(program):
    """The defaults of the ventricle's options by path."""
    run = subprocess.run([str(program), "options", "ventricle", "--markdown"], check=True, capture_output=True, text=True)
    rows = re.findall(r"^\| `([^`]+)`(?: \(\w+\))? \| ([^|]*?) \|", run.stdout, re.MULTILINE)
    return dict(reversed(rows))


def stale_options(path, root, program):
    for table in re.findall(r"^\| option \| default \|.*\n((?:\|.*\n)+)", path.read_text(), re.MULTILINE):
        known = defaults_of(program)
        for option, default in re.findall(r"^\| `([^`]+)` \| ([^|]*?) \|", table, re.MULTILINE):
            if option not in known:
                yield f"{path.relative_to(root)}: the program has no option '{option}'"
            elif known[option] != default:
                yield f"{path.relative_to(root)}: the default of '{option}' is {known[option]}, not {default}"


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


def crowded_lines(path, root):
    """Lines of prose with more than one sentence: a change of one should show as one."""
    in_block = False
    for number, line in enumerate(path.read_text().splitlines(), 1):
        in_block ^= line.startswith("```")
        if not in_block and not line.startswith(("    ", "|", "!")) and TWO_SENTENCES.search(NO_SENTENCE.sub("", line)):
            yield f"{path.relative_to(root)}:{number}: more than one sentence on a line: {line.strip()[:60]}"


def schema_parts(schema):
    yield "", schema
    yield from schema.get("$defs", {}).items()


def undescribed_keys(path, root):
    """Keys of a JSON Schema without words, from which its page is made."""
    schema = json.loads(path.read_text())
    for name, part in schema_parts(schema):
        for key, value in part.get("properties", {}).items():
            if "description" not in value and "description" not in schema["$defs"].get(value.get("$ref", "").rsplit("/", 1)[-1], {}):
                yield f"{path.relative_to(root)}: {name or 'top level'}: '{key}' has no description"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/bin/dynasurf")
    parser.add_argument("--update", action="store_true")
    parser.add_argument("--root", type=pathlib.Path, default=ROOT)
    arguments = parser.parse_args()
    root = arguments.root.resolve()
    failures, documents, size = [], 0, 0
    for path in files(root):
        failures += unfinished(path, root)
        if path.name.endswith(".schema.json"):
            failures += undescribed_keys(path, root)
        if path.suffix == ".md":
            documents += 1
            size += len(COMMENT.sub("", path.read_text()).encode())
            failures += crowded_lines(path, root)
            failures += broken_links(path, root)
            failures += figures.check(path, root, arguments.update)
            failures += stale_options(path, root, arguments.program)
    if size > LARGEST_BYTES:
        failures.append(f"the documents hold {size} bytes; at most {LARGEST_BYTES} are wanted")
    print("\n".join(failures) if failures else f"{documents} documents are in order, {size} bytes")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
