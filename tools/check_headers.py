#!/usr/bin/env python3
"""Holds the headers of src/ to docs/architecture.md.

A group is a header and the source of its name, wherever they lie in a module (`ventricle/detail/cycle.hpp` and
`ventricle/cycle.cpp`); no group includes another one in a circle. The header of a whole module includes every public
header of it and nothing else; examples include public headers alone. Public are headers outside of `detail/`.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^#include "(dynasurf/[^"]+)"', re.M)


def group_of(name):
    return name.replace("/detail/", "/").rsplit(".", 1)[0]


def includes_of_groups(files):
    """Which groups each group includes; `files` are texts by their path below src/."""
    groups = {}
    for name, text in files.items():
        others = {group_of(other) for other in INCLUDE.findall(text) if other in files}
        groups.setdefault(group_of(name), set()).update(others - {group_of(name)})
    return groups


def circles(groups):
    """Sets of groups that include each other in a circle (Tarjan, without recursion)."""
    number, low, stack, found = {}, {}, [], []
    for start in groups:
        work = [(start, iter(groups[start]))] if start not in number else []
        while work:
            group, rest = work[-1]
            if group not in number:
                number[group] = low[group] = len(number)
                stack.append(group)
            for other in rest:
                if other not in number:
                    work.append((other, iter(groups[other])))
                    break
                if other in stack:
                    low[group] = min(low[group], number[other])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[group])
                if low[group] == number[group]:
                    circle = stack[stack.index(group) :]
                    del stack[stack.index(group) :]
                    if len(circle) > 1:
                        found.append(sorted(circle))
    return found


def check(root):
    src = root / "src"
    files = {str(file.relative_to(src)): file.read_text() for file in sorted(src.glob("dynasurf/*/**/*.?pp"))}
    public = [name for name in files if name.endswith(".hpp") and "/detail/" not in name]
    failures = [f"these include each other in a circle: {', '.join(circle)}" for circle in circles(includes_of_groups(files))]
    for module in sorted({name.split("/")[1] for name in files}):
        whole = src / "dynasurf" / f"{module}.hpp"
        wanted = {name for name in public if name.split("/")[1] == module}
        has = set(INCLUDE.findall(whole.read_text())) if whole.is_file() else set()
        failures += [f"src/dynasurf/{module}.hpp: does not include {name}" for name in sorted(wanted - has)]
        failures += [f"src/dynasurf/{module}.hpp: {name} is no public header of it" for name in sorted(has - wanted)]
    for file in sorted(root.glob("examples/*.?pp")):
        inner = [name for name in INCLUDE.findall(file.read_text()) if "/detail/" in name]
        failures += [f"{file.relative_to(root)}: {name} is not public" for name in inner]
    return public, failures


def main():
    public, failures = check(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT)
    print("\n".join(failures) if failures else f"{len(public)} public headers, no circles")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
