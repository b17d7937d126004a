#!/usr/bin/env python3
"""Writes the stubs of the package, python/dynasurf/*.pyi, or with --check tells whether they are those of the module.

    PYTHONPATH=build/release/python python3 tools/python_stubs.py [--check]

Needs mypy's stubgen, which reads the signatures that pybind11 leaves in the docstrings.
"""

import importlib
import inspect
import pathlib
import re
import subprocess
import sys
import tempfile

import dynasurf
from dynasurf import _core, _options

FOLDER = pathlib.Path(__file__).resolve().parents[1] / "python/dynasurf"
ROOMS = ("image", "field", "mesh", "dynamics", "ventricle", "cloud", "synthetic", "io")
KINDS = {"float | None": "Optional[float]", "int | None": "Optional[int]", "list of int": "List[int]",
         "list of float": "List[float]",
         "list of 3 float | None": "Optional[List[float]]"}
HEAD = "# Written by tools/python_stubs.py.\nfrom typing import Any, Callable, Dict, List, Literal, Optional, Tuple, Union\n\n"


def returned(function):
    """What a numpy docstring says a function returns, where that is a class of the package."""
    found = re.search(r"Returns\n-+\n(\w+)", inspect.getdoc(function) or "")
    return found[1] if found and (hasattr(_core, found[1]) or found[1] == "Options") else "Any"


def signature(name, function, indent=""):
    """A function of the package as a line of a stub."""
    words = []
    for parameter in inspect.signature(function).parameters.values():
        if parameter.kind is parameter.KEYWORD_ONLY and "*" not in words and not any(w.startswith("*") for w in words):
            words.append("*")
        star = {parameter.VAR_POSITIONAL: "*", parameter.VAR_KEYWORD: "**"}.get(parameter.kind, "")
        typed = "" if parameter.name == "self" else ": Any"
        default = " = ..." if parameter.default is not parameter.empty else ""
        words.append(star + parameter.name + typed + default)
    result = "None" if name == "__init__" else returned(function)
    return f"{indent}def {name}({', '.join(words)}) -> {result}: ..."


def property_type(owner, name):
    """What the getter of a property returns, by pybind11's signature of it; stubgen takes the text behind it for one."""
    getter = inspect.getattr_static(owner, name).fget
    found = re.search(r"-> (.+)", getter.__doc__ or "")
    if not found or inspect.isfunction(getter):  # a property that Python adds
        return "Any"
    told = re.sub(r"numpy\.ndarray\[.*", "numpy.ndarray", found[1].strip().replace("dynasurf._core.", ""))
    return re.sub(r"\[(int|float)\[\d\]\]", r"[\1]", told)


def to_fill(owner):
    """The static method that gives an object and arrays of its own memory."""
    of_mesh = "vertices: int, triangles: Any) -> Tuple[TriMesh, numpy.ndarray]"
    of_study = "shape: Any, spacing: Any = ..., affine: Any = ..., **facts: Any) -> Tuple[Study, List[numpy.ndarray]]"
    of_volume = f"shape: Any, spacing: Any = ..., affine: Any = ...) -> Tuple[{owner}, numpy.ndarray]"
    return f"    def to_fill({ {'TriMesh': of_mesh, 'Study': of_study}.get(owner, of_volume) }: ..."


def core():
    """The C++ module, by stubgen; methods that Python adds get the signatures they have."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["stubgen", "-q", "-m", "dynasurf._core", "-o", folder], check=True, stdout=subprocess.DEVNULL)
        text = (pathlib.Path(folder) / "dynasurf/_core.pyi").read_text()
    lines, owner = [], None
    for line in text.splitlines():
        if named := re.match(r"class (\w+)", line):
            owner = getattr(_core, named[1])
        added = re.match(r"    (\w+): ClassVar\[(function|property)\] = \.\.\.", line)
        line = re.sub(r"numpy\.ndarray\[[\w., ]*\]", "numpy.ndarray", line).replace("__eq__(self, arg0: Estimate)", "__eq__(self, arg0: object)")
        if "__hash__: ClassVar[None]" in line:
            continue
        if (told := re.match(r"    def (\w+)\(self\) -> ", line)) and lines[-1] == "    @property":
            lines.append(f"{told[0]}{property_type(owner, told[1])}: ...")
        elif line.startswith("    def from_nibabel("):
            lines += ["    @staticmethod", signature("from_nibabel", owner.from_nibabel, "    ")]
        elif line.startswith("    def to_fill("):
            lines += ["    @staticmethod", to_fill(owner.__name__)]
        elif added:
            method = inspect.getattr_static(owner, added[1])
            names = [*inspect.signature(method).parameters]
            lines.append(re.sub(rf"\({names[0]}: Any", "(self", signature(added[1], method, "    ")))
        else:
            lines.append(line)
    return HEAD + "\n".join(lines) + "\n"


def option_type(member):
    if member.kind == "word":
        return f"Literal[{', '.join(repr(w) for w in member.words)}]"
    names = [f"_{c.split('.')[0]}.{c.split('.')[1]}" for c in member.classes]
    if member.kind == "family":
        return f"Union[{', '.join([*names, 'str'])}]"
    return names[0] if names else KINDS.get(member.kind, member.kind)


def option_class(name, kind):
    members = {n: option_type(m) for n, m in kind._members.items()}
    arguments = "".join(f", {n}: {t} = ..." for n, t in members.items())
    lines = [f"class {name}(_Options):", *(f"    {n}: {t}" for n, t in members.items())]
    return "\n".join([*lines, f"    def __init__(self{', *' if members else ''}{arguments}) -> None: ..."])


def room(name):
    """One room: what it takes from the C++ module, its functions, its options."""
    module = importlib.import_module(f"dynasurf.{name}")
    options = _options.classes_of(name)
    parts, functions = [], []
    for public in module.__all__:
        thing = getattr(module, public)
        if public in options:
            parts.append(option_class(public, thing))
        elif hasattr(_core, public) and getattr(_core, public) is thing:
            functions.append(f"from ._core import {public} as {public}")
        elif inspect.isclass(thing):
            functions.append(f"class {public}:\n" + "\n".join(
                signature(n, getattr(thing, n), "    ").replace("__init__(self", "__init__(self")
                for n in ("__init__", "__iter__", "__next__", "close")) + "\n    result: Any")  # fmt: skip
        else:
            functions.append(signature(public, thing))
    used = sorted(set(re.findall(r"\b_(\w+)\.", "\n".join(parts))) & set(ROOMS))
    classes = set(re.findall(r"-> (\w+):", "\n".join(functions))) - {"Any", "None", *options}
    known = set(re.findall(r" as (\w+)", "\n".join(functions)))
    head = [f"from . import {r} as _{r}" for r in used] + ["from ._options import Options as _Options"]
    head += [f"from ._core import {c} as {c}" for c in sorted(classes - known)]
    return HEAD + "\n".join(head + functions) + "\n\n" + "\n\n".join(parts) + "\n"


def main():
    texts = {"_core": core(), **{name: room(name) for name in ROOMS}}
    stale = [n for n, t in texts.items() if not (FOLDER / f"{n}.pyi").is_file() or (FOLDER / f"{n}.pyi").read_text() != t]
    if sys.argv[1:] == ["--check"]:
        print(f"stubs that are not those of the module: {', '.join(stale)}" if stale else "the stubs are those of the module")
        return 1 if stale else 0
    for name, text in texts.items():
        (FOLDER / f"{name}.pyi").write_text(text)
    print(f"dynasurf {dynasurf.__version__}: {len(texts)} stubs, {len(stale)} of them new")
    return 0


if __name__ == "__main__":
    sys.exit(main())
