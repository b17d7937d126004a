#!/usr/bin/env python3
"""Checks docs/thesis-map.md: every item of tools/thesis_items.txt has a row, or a reason under "Not built", and every
row of its tables names files and tests that exist.

A row is | item | thesis | file | test |. Files are paths in backquotes, below src/dynasurf/ or from the root. Tests are
in backquotes too: `Suite.Name` or `Suite` (any test of it) of a GoogleTest program, or a path below tests/ or web/.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def known_tests(root):
    tests = set()
    for file in root.glob("tests/**/*.cpp"):
        for suite, name in re.findall(r"\bTEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)", file.read_text()):
            tests |= {suite, f"{suite}.{name}"}
        tests |= set(re.findall(r"\bTYPED_TEST(?:_SUITE)?\(\s*(\w+)", file.read_text()))
    return tests


def missing_items(root, text):
    """Items that stand in no first cell of a row, nor before a reason: `* ITEM: why`."""
    told = set()
    for line in text.splitlines():
        if line.startswith("|"):
            told |= set(re.findall(r"\b[A-Z0-9]+(?:-[A-Z0-9]+)*\b", line.strip("|").split("|")[0]))
        elif reason := re.match(r"\* ([A-Z0-9-]+): \S", line):
            told.add(reason[1])
    return [item for item in (root / "tools/thesis_items.txt").read_text().split() if item not in told]


def check(root):
    tests, failures, rows = known_tests(root), [], 0
    failures += [f"docs/thesis-map.md: no row for {item}"
                 for item in missing_items(root, (root / "docs/thesis-map.md").read_text())]
    for number, line in enumerate((root / "docs/thesis-map.md").read_text().splitlines(), 1):
        if not line.startswith("|") or set(line) <= set("|-: "):
            continue
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if cells[0] == "item":
            continue
        where = f"docs/thesis-map.md:{number}"
        if len(cells) != 4:
            failures.append(f"{where}: expected 4 cells, found {len(cells)}")
            continue
        rows += 1
        for kind, cell in (("file", cells[2]), ("test", cells[3])):
            names = re.findall(r"`([^`]+)`", cell)
            if not names:
                failures.append(f"{where}: no {kind} for {cells[0]}")
            for name in names:
                is_path = kind == "file" or "/" in name
                is_file = (root / name).is_file() or kind == "file" and (root / "src/dynasurf" / name).is_file()
                if not (is_file if is_path else name in tests):
                    failures.append(f"{where}: {kind} '{name}' does not exist")
    if rows == 0:
        failures.append("docs/thesis-map.md: no rows found")
    return failures, rows


def main():
    failures, rows = check(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT)
    print("\n".join(failures) if failures else f"all items are told; {rows} rows name files and tests that exist")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
