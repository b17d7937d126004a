#!/usr/bin/env python3
"""Holds every #include of src/ and app/ against the table of modules in docs/architecture.md.

A module includes itself and what its line allows; third-party headers only where its line names the library. What the
headers of `core` show (Eigen) is open to all. "(one source)" in the table means that one file at most includes it.
"""

import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

# How the libraries of the table look in an #include.
LIBRARIES = {
    "Eigen": r"Eigen/",
    "oneTBB": r"(oneapi/)?tbb/",
    "DCMTK": r"dcmtk/",
    "zlib": r"zlib\.h$",
    "libpng": r"png\.h$",
    "pugixml": r"pugixml\.hpp$",
    "meshoptimizer": r"meshoptimizer\.h$",
    "OpenSSL": r"openssl/",
    "nlohmann-json": r"nlohmann/",
    "CLI11": r"CLI/",
    "SQLite": r"sqlite3\.h$",
    "cairo": r"cairo(-svg)?\.h$",
}
OPEN_TO_ALL = {"Eigen"}
# Headers of the operating system have no place below the floor of files and programs.
SYSTEM = re.compile(r"(sys/)?[a-z_0-9]+\.h$")
LOWEST_FLOOR_WITH_SYSTEM = 5
# Vector instructions belong to the compiler.
COMPILER = {"immintrin.h"}


class Module:
    def __init__(self, floor, modules, libraries):
        self.floor, self.modules, self.libraries = floor, modules, libraries


def read_table(text):
    """The modules of docs/architecture.md, and the libraries that one source at most may include."""
    modules, single = {}, set()
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if len(cells) != 5 or not cells[0].isdigit():
            continue
        floor, name, _, may_include, third_party = cells
        libraries = set()
        for library in third_party.split(","):
            library = library.strip()
            bare = library.replace("(one source)", "").strip()
            if bare in ("", "-"):
                continue
            if bare not in LIBRARIES:
                sys.exit(f"docs/architecture.md: module {name}: unknown library '{bare}'")
            libraries.add(bare)
            if bare != library:
                single.add((name, bare))
        allowed = {word.strip() for word in may_include.split(",")} - {"-"}
        modules[name] = Module(int(floor), allowed, libraries)
    if not modules:
        sys.exit("docs/architecture.md: the table of modules was not found")
    for name, module in modules.items():
        for other in module.modules - {"all"}:
            if other not in modules:
                sys.exit(f"docs/architecture.md: module {name} may include '{other}', which is no module")
            if modules[other].floor > module.floor:
                sys.exit(f"docs/architecture.md: module {name} may include {other}, which stands above it")
    return modules, single


def complaint(name, modules, target, quoted):
    """Why a file of module `name` may not include `target`; None when it may. The library it is part of, if any."""
    module = modules[name]
    if target.startswith("dynasurf/"):
        other = target.split("/")[1].removesuffix(".hpp")
        if other not in modules:
            return f"there is no module '{other}'", None
        if other == name or "all" in module.modules or other in module.modules:
            return None, None
        return f"{name} may not include {other}", None
    if quoted:
        if name in ("app", "python") and "/" not in target:
            return None, None
        return "own headers are included by their full path from dynasurf/", None
    for library, pattern in LIBRARIES.items():
        if re.match(pattern, target):
            if library in module.libraries or library in OPEN_TO_ALL:
                return None, library
            return f"{name} may not use {library}", library
    if re.fullmatch(r"[a-z_0-9]+", target) or target in COMPILER:
        return None, None
    if SYSTEM.match(target):
        if module.floor >= LOWEST_FLOOR_WITH_SYSTEM:
            return None, None
        return f"{name} may not use headers of the operating system", None
    return f"{target} belongs to no library of docs/architecture.md", None


def check(root):
    modules, single = read_table((root / "docs/architecture.md").read_text())
    failures, users = [], collections.defaultdict(list)
    for file in sorted(root.glob("src/dynasurf/**/*")) + sorted(root.glob("app/**/*")):
        if file.suffix not in (".cpp", ".hpp"):
            continue
        relative = file.relative_to(root)
        name = "app" if relative.parts[0] == "app" else relative.parts[2].removesuffix(".hpp")
        if name not in modules:
            failures.append(f"{relative}: module '{name}' does not stand in docs/architecture.md")
            continue
        for number, line in enumerate(file.read_text().splitlines(), 1):
            match = re.match(r'\s*#\s*include\s*([<"])([^>"]+)[>"]', line)
            if not match:
                continue
            problem, library = complaint(name, modules, match[2], match[1] == '"')
            if problem:
                failures.append(f"{relative}:{number}: {problem} ({match[2]})")
            if (name, library) in single and relative not in users[name, library]:
                users[name, library].append(relative)
    for (name, library), files in users.items():
        if len(files) > 1:
            failures.append(f"{library} is meant for one source of {name}: {', '.join(map(str, files))}")
    return failures


def main():
    failures = check(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT)
    print("\n".join(failures) if failures else "all includes are allowed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
