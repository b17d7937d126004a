#!/usr/bin/env python3
"""Finds types that are defined twice under one name: linked into one program they are one type with two layouts.

Looks at every struct, class, union and enum at namespace scope of src/ and app/, outside unnamed namespaces, and in
those of app/, whose sources are compiled several at once.
"""

import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
OPEN = re.compile(r"(?:inline )?namespace(?: ([\w:]+))? \{$")
TYPE = re.compile(r"(?:template <.*> )?(?:struct|class|union|enum class|enum) (?:alignas\(\w+\) )?(\w+)(?: final)?(?: : [^;{]*)?(?: \{.*)?;?$")


def types_of(text, unnamed):
    """The names of types defined at namespace scope, with their namespace; `unnamed`: in unnamed ones too. Formatted
    sources: types start a line."""
    scope = []
    for line in text.splitlines():
        if match := OPEN.match(line):
            scope.append(match[1] or "")
        elif re.match(r"\}  // (inline )?namespace", line):
            scope.pop()
        elif (unnamed or "" not in scope) and (match := TYPE.match(line)) and ("{" in line or not line.endswith(";")):
            yield "::".join([*filter(None, scope), match[1]])


def main():
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT
    places = collections.defaultdict(list)
    for file in sorted([*root.glob("src/dynasurf/**/*.?pp"), *root.glob("app/*.?pp")]):
        for name in types_of(file.read_text(), file.parent.name == "app"):
            places[name].append(str(file.relative_to(root)))
    twice = {name: files for name, files in places.items() if len(files) > 1}
    for name, files in twice.items():
        print(f"{name} is defined in {' and in '.join(files)}")
    if not twice:
        print(f"{len(places)} types, none defined twice")
    return 1 if twice else 0


if __name__ == "__main__":
    sys.exit(main())
