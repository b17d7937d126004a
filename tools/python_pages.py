#!/usr/bin/env python3
"""Writes the pages of the Python module for `./dev docs`, one per room, from the docstrings of the module itself.

    PYTHONPATH=build/release/python python3 tools/python_pages.py FOLDER

FOLDER gets python-api.md, which lists the rooms, and python-ROOM.md for each of them.
"""

import inspect
import pathlib
import re
import sys

import dynasurf
from dynasurf import _core

ROOMS = ("image", "field", "mesh", "dynamics", "ventricle", "cloud", "synthetic", "io")
TYPES = [(r"dynasurf\._core\.", ""), (r"numpy\.ndarray\[[^\]]*\]", "ndarray"), (r"handle\b", "Any")]


def plain(text):
    """Text in which Markdown and Doxygen see no marks of theirs."""
    return re.sub(r"([\\`*_<>@#$|])", r"\\\1", text)


def code(text):
    return "\n".join(["```", text, "```"])


def sections(doc):
    """The parts of a numpy docstring: the words before the first heading, then (heading, text)."""
    parts = re.split(r"^([A-Z][\w ]+)\n-+\n", doc, flags=re.M)
    return parts[0].strip(), list(zip(parts[1::2], (text.rstrip() for text in parts[2::2])))


def signature(name, thing):
    doc = inspect.getdoc(thing) or ""
    told = re.match(rf"{re.escape(name)}\(.*\) -> .*", doc)
    if told:  # pybind11 leaves it there
        text = told[0]
        for pattern, word in TYPES:
            text = re.sub(pattern, word, text)
        return text, doc[told.end():].strip()
    try:
        return name + re.sub(r"<[^>]*>", "...", str(inspect.signature(thing))), doc
    except (TypeError, ValueError):
        return name, doc


def function_page(name, thing):
    call, doc = signature(name, thing)
    words, parts = sections(doc)
    lines = [f"## {name}", code(call), plain(words)]
    for heading, text in parts:
        lines += [f"**{heading}**", code(text)]
    return lines


def member_lines(kind):
    """The properties and methods of a class, each with the first line of what it says."""
    for name, member in sorted(vars(kind).items()):
        if name.startswith("_"):
            continue
        if not isinstance(member, property) and not callable(member) and not isinstance(member, staticmethod):
            continue
        doc = inspect.getdoc(member if isinstance(member, property) else getattr(kind, name)) or ""
        doc = re.sub(r"^(\w+\(.*\) -> .*\n+|\(self.*\) -> .*\n*)", "", doc)
        first = doc.strip().split("\n\n")[0].replace("\n", " ")
        yield f"- **{plain(name)}**{'' if isinstance(member, property) else '()'} {plain(first)}".rstrip()


def class_page(name, kind):
    words, parts = sections(inspect.getdoc(kind) or "")
    is_options = issubclass(kind, dynasurf._options.Options)
    lines = [f"## {name}{' (options)' if is_options else ''}", plain(words)]  # names of functions differ in case alone
    for heading, text in parts:
        lines += [f"**{heading}**", code(text)]
    if not is_options:
        lines.append("\n".join(member_lines(kind)))
    return lines


def page(title, module, names):
    lines = [f"# {title}", plain((inspect.getdoc(module) or "").split("\n\n")[0])]
    for name in sorted(names):
        thing = getattr(module, name)
        if inspect.ismodule(thing) or name == "Options" and thing is dynasurf._options.Options:
            continue
        lines += class_page(name, thing) if inspect.isclass(thing) else function_page(name, thing)
    return "\n\n".join(line for line in lines if line) + "\n"


def main():
    folder = pathlib.Path(sys.argv[1])
    core = [n for n in dynasurf.__all__ if getattr(getattr(dynasurf, n), "__module__", "") == _core.__name__]
    titles = {"python-dynasurf": page("dynasurf", dynasurf, [*core, "load", "progress_of"])}
    for room in ROOMS:
        module = getattr(dynasurf, room)
        titles[f"python-{room}"] = page(f"dynasurf.{room}", module, [n for n in module.__all__ if n not in core])
    for name, text in titles.items():
        (folder / f"{name}.md").write_text(text)
    listed = "\n".join(f"- [{name.replace('python-', 'dynasurf.').replace('dynasurf.dynasurf', 'dynasurf')}]({name}.md)" for name in titles)
    books = "\n".join(f"- [{b.stem}](../docs/notebooks/{b.stem}.html)" for b in sorted(pathlib.Path("python/notebooks").glob("*.ipynb")))
    (folder / "python-api.md").write_text(
        f"# Python module\n\nEvery function and class of the module, from its docstrings.\n\n{listed}\n\n"
        f"## Notebooks\n\n{books}\n"
    )


if __name__ == "__main__":
    main()
