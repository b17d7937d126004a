#!/usr/bin/env python3
"""Holds the sources of src/, app/ and tests/ to what CONTRIBUTING.md asks of them.

A source of a module lies in the module's namespace (`dynasurf` for core, `dynasurf::mesh` for mesh, ...). A file has at
most 500 lines, one of app/ 150, and a function 60. Every name that a public header shows, or one of `detail/` that it
includes, has a sentence. The tests of a module lie in folders as its sources do, and X_test.cpp beside where X is.
Formatted sources are expected: what stands at namespace scope begins its line.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LONGEST_FILE, LONGEST_OF_APP, LONGEST_FUNCTION = 500, 150, 60
TABLES = re.compile(r"_tables\.hpp$")  # numbers, written by a script

OPEN = re.compile(r"(?:inline )?namespace dynasurf((?:::\w+)*) \{")
NO_FUNCTION = re.compile(r"(namespace|struct|class|union|enum|extern|using|template|inline namespace|//|#|\}|\s|$)")
DECLARATION = re.compile(r"(struct|class|union|enum|inline|constexpr|template|using|concept|[A-Za-z_][\w:]*[<&* ])")
# Words of an enumeration, descriptions of options and forward declarations say nothing new.
PLAIN = re.compile(
    r"(inline )?std::(span<const std::string_view> names_of|string_view name_of)\(|void describe\(|(struct|class) \w+;|using namespace |\};?|"
    r"template <.*>$|struct Is\w+"
)


def namespace_failures(name, module, lines):
    """Namespaces of a module's source that are not the module's."""
    expected = "" if module == "core" else f"::{module}"
    for number, line in enumerate(lines, 1):
        match = OPEN.match(line)
        if match and not (match[1] + "::").startswith(expected + "::") and not forward_only(lines, number):
            yield f"{name}:{number}: namespace dynasurf{match[1]}; expected dynasurf{expected}"


def forward_only(lines, number):
    """Whether the namespace that opens in a line holds forward declarations alone."""
    for line in lines[number:]:
        if line.startswith("}"):
            return True
        if line.strip() and not re.match(r"(struct|class) \w+;", line):
            return False
    return False


def functions(lines):
    """First line (from 1) and length of every function at namespace scope."""
    start = None
    for number, line in enumerate(lines):
        if start is None and not NO_FUNCTION.match(line) and "(" in line:
            for later in lines[number : number + 8]:
                if later.rstrip().endswith(("{", ";", "}")):
                    if later.rstrip().endswith("{"):
                        start = number
                    break
        elif start is not None and line.startswith("}"):
            yield start + 1, number - start + 1
            start = None


def size_failures(name, lines):
    longest = LONGEST_OF_APP if name.startswith("app/") else LONGEST_FILE
    if len(lines) > longest:
        yield f"{name}: has {len(lines)} lines; expected at most {longest}"
    for start, length in functions(lines):
        if length > LONGEST_FUNCTION:
            yield f"{name}:{start}: this function has {length} lines; expected at most {LONGEST_FUNCTION}"


def is_documented(lines, at):
    """Whether a declaration, or the group that it ends, has a comment."""
    if "//" in lines[at]:
        return True
    for line in reversed(lines[:at]):
        if line.lstrip().startswith("//"):
            return True
        if not line.strip() or line.startswith("}"):
            return False
    return False


def sentence_failures(name, lines):
    for number, line in enumerate(lines):
        if line.startswith("// -----"):  # definitions of what is declared above
            return
        if DECLARATION.match(line) and not line.startswith("namespace") and not PLAIN.match(line):
            if not is_documented(lines, number):
                yield f"{name}:{number + 1}: '{line.strip()[:60]}' has no sentence"


def shown(root):
    """The headers that whoever includes a public one sees."""
    src = root / "src"
    seen, rest = set(), [file for file in src.glob("dynasurf/*/**/*.hpp") if "detail" not in file.parts]
    while rest:
        file = rest.pop()
        if file not in seen and file.is_file():
            seen.add(file)
            rest += [src / name for name in re.findall(r'^#include "(dynasurf/[^"]+)"', file.read_text(), re.M)]
    return seen


def misplaced_tests(root):
    """Tests of modules that do not lie where the sources lie which they are named after."""
    sources = root / "src/dynasurf"
    folders = {}  # of each module and name
    for file in sources.glob("*/**/*.?pp"):
        folder = file.parent.parent if file.parent.name == "detail" else file.parent
        folders.setdefault((file.relative_to(sources).parts[0], file.stem), set()).add(folder.relative_to(sources))
    for test in sorted(root.glob("tests/*/**/*_test.cpp")):
        folder = test.parent.relative_to(root / "tests")
        if not (sources / folder.parts[0]).is_dir():
            continue
        expected = folders.get((folder.parts[0], test.stem.removesuffix("_test")), {folder})
        if folder not in expected:
            yield f"{test.relative_to(root)}: expected in tests/{min(expected)}, as the source of this name"
        elif not (sources / folder).is_dir():
            yield f"{test.relative_to(root)}: src/dynasurf has no folder {folder}"


def check(root):
    seen = shown(root)
    files = sorted([*root.glob("src/dynasurf/**/*.?pp"), *root.glob("app/*.?pp")])
    failures = []
    for file in files:
        name = str(file.relative_to(root))
        parts = file.relative_to(root).parts
        lines = file.read_text().splitlines()
        if not TABLES.search(name):
            failures += size_failures(name, lines)
        if parts[0] == "src" and len(parts) > 3:
            failures += namespace_failures(name, parts[2], lines)
            if file in seen:
                failures += sentence_failures(name, lines)
    failures += misplaced_tests(root)
    return files, failures


def main():
    files, failures = check(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT)
    print("\n".join(failures) if failures else f"{len(files)} sources are in order")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
