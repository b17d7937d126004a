#!/usr/bin/env python3
"""Runs two builds of the program on the same inputs and tells which result files differ.

    compare_programs.py OLD NEW [--rename OLD_PREFIX=NEW_PREFIX]... [--skip NAME]... [--set A=B]... INPUT...

An INPUT is a study (DICOM folder or file, NIfTI, NRRD) or a cloud (PLY, XYZ, PTS, LAS). Files are compared by their
bytes. `--rename meshes/fit_=meshes/` compares the old file meshes/fit_endo_g01.ply with the new meshes/endo_g01.ply; of
several prefixes that fit the first counts. `--skip` leaves files of that name out. Ends with 1 when anything differs.
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile

CLOUDS = {".ply", ".xyz", ".pts", ".las", ".csv", ".txt"}


def run(program, source, out, settings):
    command = "cloud" if source.suffix in CLOUDS else "ventricle"
    more = [word for setting in settings for word in ("--set", setting)] if command == "ventricle" else []
    done = subprocess.run([program, command, source, "--out", out, "--no-timings", "--quiet", *more],
                          capture_output=True, text=True)
    if done.returncode not in (0, 3):
        print(f"{source}: {program} ended with {done.returncode}: {done.stderr.strip()}")
    return done.returncode


def renamed(name, renames):
    for old, new in renames:
        if name.startswith(old):
            return new + name[len(old):]
    return name


def files_of(folder):
    return {str(path.relative_to(folder)): path for path in sorted(folder.rglob("*")) if path.is_file()}


def differences(old, new, renames, skip):
    there = files_of(new)
    for name, path in files_of(old).items():
        if pathlib.PurePath(name).name in skip:
            continue
        target = there.get(renamed(name, renames))
        if target is None:
            yield f"{name}: not there any more"
        elif target.read_bytes() != path.read_bytes():
            yield f"{name}: differs"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=pathlib.Path)
    parser.add_argument("new", type=pathlib.Path)
    parser.add_argument("inputs", nargs="+", type=pathlib.Path)
    parser.add_argument("--rename", action="append", default=[])
    parser.add_argument("--skip", action="append", default=["manifest.txt"])
    parser.add_argument("--set", action="append", default=[], dest="settings")
    arguments = parser.parse_args()
    renames = [rename.split("=", 1) for rename in arguments.rename]
    failed = compared = 0
    for source in arguments.inputs:
        with tempfile.TemporaryDirectory() as scratch:
            old, new = pathlib.Path(scratch, "old"), pathlib.Path(scratch, "new")
            codes = [run(program, source, out, arguments.settings)
                     for program, out in ((arguments.old, old), (arguments.new, new))]
            found = [f"exit code {codes[0]} became {codes[1]}"] if codes[0] != codes[1] else []
            if old.is_dir() and new.is_dir():
                found += differences(old, new, renames, set(arguments.skip))
                compared += len(files_of(old))
            failed += bool(found)
            print(f"{source}: {'; '.join(found) if found else 'the same'}", flush=True)
    print(f"{compared} files of {len(arguments.inputs)} inputs compared, {failed} inputs differ")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
