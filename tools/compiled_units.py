#!/usr/bin/env python3
"""What a build folder compiles of some folders of the sources, a line each: sources, and files that join several.

    compiled_units.py BUILD FOLDER...
"""
import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def sources_of(unit):
    """The sources that a unit joins, or the unit itself."""
    joined = re.findall(r'#include "(.*\.cpp)"', unit.read_text()) if unit.parent.name == "Unity" else []
    return [Path(source) for source in joined] or [unit]


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__.strip())
    build, folders = Path(sys.argv[1]), [ROOT / name for name in sys.argv[2:]]
    units = {Path(entry["file"]) for entry in json.loads((build / "compile_commands.json").read_text())}
    wanted = {path for folder in folders for path in folder.rglob("*.cpp")}
    for unit in sorted(units):
        if unit.exists() and wanted.intersection(sources_of(unit)):
            print(unit)


if __name__ == "__main__":
    main()
