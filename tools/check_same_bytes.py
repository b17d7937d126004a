#!/usr/bin/env python3
"""Refuses in src/ and app/ what gives other numbers with another library, compiler or processor.

Elementary functions come from dynasurf/core/detail/elementary.hpp, draws from dynasurf/synthetic/detail/random.hpp. What <cmath>
computes exactly on every machine may stay: sqrt, fma, fmod, remainder, floor, round, ldexp and their kin.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

# They may name what they replace.
EXCEPTED = re.compile(r"src/dynasurf/core/(?:detail/)?(elementary\w*|twofold)\.[ch]pp$")

ROUNDED = ("exp|exp2|expm1|log|log1p|log2|log10|pow|sin|cos|tan|sincos|asin|acos|atan|atan2|sinh|cosh|tanh|asinh|acosh|"
           "atanh|cbrt|hypot|erf|erfc|lgamma|tgamma")
# No result depends on what is drawn here: it keeps hostile files from making all keys of a table fall together.
ALLOWED = {("src/dynasurf/io/stl.cpp", "std::random_device")}

RULES = [
    (rf"\bstd::({ROUNDED})[fl]?\b(?!\w)", "each library rounds it in its own way; expected own::{0} (core/elementary.hpp)"),
    (rf"(?<![\w:.>])(::)?({ROUNDED})[fl]?\(", "each library rounds it in its own way; expected the function of own::"),
    (rf"\.({ROUNDED})\(\)", "Eigen takes it from the library; expected unaryExpr(&own::...)"),
    (r"\bstd::(polar|arg)\b", "made of angles of the library; expected functions of own::"),
    (r"\bstd::(lerp|reduce|transform_reduce)\b", "its order of operations is the library's"),
    (r"\bstd::\w+_distribution\b|\bstd::(shuffle|sample|random_device)\b",
     "each library draws in its own way; expected synthetic/random.hpp"),
    (r"\bAngleAxis|\bcomputeDirect\b|\beulerAngles\b|\.slerp\(|\.angularDistance\(",
     "Eigen takes sines and angles from the library here"),
    (r"\blong double\b|\b__float128\b", "another number on another processor"),
    (r"\bstd::hash\b", "each library hashes in its own way"),
]


def without_words(text):
    """The same lines with comments and strings left out."""
    keep_lines = lambda match: "\n" * match[0].count("\n") or '""'
    text = re.sub(r'R"(\w*)\(.*?\)\1"', keep_lines, text, flags=re.S)
    return re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', keep_lines, text, flags=re.S)


def check(root):
    failures = []
    for file in sorted(root.glob("src/dynasurf/**/*")) + sorted(root.glob("app/**/*")):
        relative = file.relative_to(root).as_posix()
        if file.suffix not in (".cpp", ".hpp") or EXCEPTED.match(relative):
            continue
        for number, line in enumerate(without_words(file.read_text()).splitlines(), 1):
            for pattern, why in RULES:
                if match := re.search(pattern, line):
                    name = match[0].strip("(.)")
                    if (relative, name) in ALLOWED:
                        continue
                    failures.append(f"{relative}:{number}: {name}: {why.format(match[1] if match.groups() else '')}")
    return failures


def main():
    failures = check(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT)
    print("\n".join(failures) if failures else "nothing depends on the library's numbers")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
