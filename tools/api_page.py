#!/usr/bin/env python3
"""Writes docs/api.md from the contract comments of the headers; check_docs.py holds the page against them.

    api_page.py [--root FOLDER]

Every name that a header of src/dynasurf declares in namespace dynasurf stands on the page with the first sentence of its
comment; the header has the rest.
"""

import argparse
import pathlib
import re

MODULES = {
    "core": "Grids, volumes, meshes, studies, options, notes and errors",
    "image": "Intensities, edges, positions inside pixels",
    "field": "Edge maps, gradient vector flow, sampling",
    "mesh": "Shapes, measures, repair, smoothing, marching cubes, interpolation in time",
    "synthetic": "Phantoms and virtual patients with known truth",
    "dynamics": "Particles, forces, solvers, models, evolution",
    "ventricle": "From a study to surfaces and numbers",
    "io": "Files in and out",
    "report": "Results and report",
}
# Declared beside every options struct, enumeration and method, and explained in core/options.hpp.
EVERYWHERE = {"describe", "names_of", "name_of"}
HEAD = """# The library, name by name

Written by `tools/api_page.py` from the headers, which hold the whole contract: shapes, units and order of arrays, what
must hold before, degenerate cases, sources, exceptions. Everything lives in namespace `dynasurf`; modules are explained in
[architecture.md](architecture.md), options in [options.md](options.md). `describe`, `names_of` and `name_of` are
declared for every options struct and enumeration.
"""


def first_sentence(comment):
    text = " ".join(line.strip() for line in comment)
    # A full stop ends the sentence when a capital or nothing follows; "eq. 3" and "fig. 2" do not.
    match = re.match(r"(.*?[.:;!?])(?=\s+[A-Z`]|$)", text)
    return (match[1] if match else text).rstrip(":;").replace("|", "\\|")


def name_of(declaration):
    """Kind and name of a declaration, or None for what the page leaves out."""
    plain = re.sub(r"template\s*<[^{;]*?>\s*(?=[a-z\[])", "", declaration).strip()
    match = re.match(r"(struct|class|enum class|enum|concept|using)\s+(?!namespace\b)(\w+)", plain)
    if match:
        if match[1] in ("struct", "class") and re.match(r"(struct|class)\s+\w+\s*(<.*>)?\s*;", plain):
            return None  # announced here, declared elsewhere
        return match[1].replace("enum class", "enum"), match[2]
    if plain.startswith(("#", "}", "namespace", "static_assert", "extern")):
        return None
    match = re.match(r"[^({=]*?\b(operator\S+|\w+)\s*\(", plain)
    if match and "=" not in plain[: match.end()]:
        return "function", match[1]
    match = re.match(r"(?:inline )?(?:constexpr|const)\b.*?\b(\w+)\s*(?:\[\])?\s*[={]", plain)
    return ("constant", match[1]) if match else None


def declarations(path):
    """(kind, name, sentence) of what stands at the left margin of a header, in order."""
    comment, lines = [], path.read_text().splitlines()
    detail, number = False, 0
    while number < len(lines):
        line = lines[number]
        number += 1
        if re.match(r"namespace \S*detail", line) or re.match(r"namespace \{", line):
            detail = True
        if detail:
            detail = not re.match(r"\}\s*// namespace", line)
            continue
        if line.startswith("///"):
            comment.append(line[3:])
            continue
        if not line or not re.match(r"[A-Za-z\[]", line):
            comment = [] if not line else comment
            continue
        text = line
        while not re.search(r"[;{]", text) and number < len(lines):
            text += " " + lines[number].strip()
            number += 1
        found = name_of(text)
        if found and found[1] not in EVERYWHERE:
            yield found[0], found[1], first_sentence(comment)
        comment = []


def page(root):
    text = HEAD
    source = root / "src" / "dynasurf"
    modules = sorted((p for p in source.iterdir() if p.is_dir()), key=lambda p: (list(MODULES) + [p.name]).index(p.name))
    for module in modules:
        text += f"\n## {module.name}\n\n{MODULES.get(module.name, module.name)}.\n"
        for header in sorted(module.rglob("*.hpp")):
            entries, known = {}, set()
            for kind, name, sentence in declarations(header):
                shown = f"`{name}()`" if kind == "function" else f"`{name}`"
                if sentence or shown not in known:  # further overloads without a comment of their own say nothing
                    entries.setdefault((shown, sentence), kind)
                known.add(shown)
            if not entries:
                continue
            path = header.relative_to(source)
            text += f"\n### [{path}](../src/dynasurf/{path})\n\n| name | kind | what |\n|---|---|---|\n"
            for (shown, sentence), kind in entries.items():
                text += f"| {shown} | {kind} | {sentence} |\n"
    return text


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent.parent)
    root = parser.parse_args().root
    (root / "docs" / "api.md").write_text(page(root))


if __name__ == "__main__":
    main()
