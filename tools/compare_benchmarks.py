#!/usr/bin/env python3
"""Compares the times of two runs of the benchmarks, made on one machine.

    compare_benchmarks.py OLD NEW [--loss PERCENT]

OLD and NEW are folders of Google Benchmark's JSON files, as `./dev bench` leaves them in build/bench/results, or single
files. Of several repetitions the fastest counts. Prints old and new time and their ratio for every benchmark that both
runs have; ends with 1 when one takes PERCENT (10) longer than it did, with 2 when the runs cannot be compared.
"""

import argparse
import json
import pathlib
import sys

NANOSECONDS = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}


def refuse(message):
    print(f"{pathlib.Path(sys.argv[0]).stem}: {message}", file=sys.stderr)
    raise SystemExit(2)


def read(path):
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError) as error:
        refuse(f"{path}: {error}")


def times_of(source):
    """Least time (ns) of each benchmark, and the processors that the runs were made on."""
    files = sorted(source.glob("*.json")) if source.is_dir() else [source]
    if not files:
        refuse(f"{source} holds no *.json; expected results of ./dev bench")
    times, processors = {}, set()
    for file in files:
        result = read(file)
        context = result.get("context", {})
        processors.add((context.get("host_name"), context.get("num_cpus")))
        for row in result.get("benchmarks", []):
            if row.get("run_type", "iteration") != "iteration" or row.get("error_occurred"):
                continue
            time = row["real_time"] * NANOSECONDS[row.get("time_unit", "ns")]
            name = f"{file.stem}: {row['name']}"
            times[name] = min(time, times.get(name, time))
    return times, processors


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=pathlib.Path)
    parser.add_argument("new", type=pathlib.Path)
    parser.add_argument("--loss", type=float, default=10, help="percent that a benchmark may become slower")
    given = parser.parse_args()
    (old, old_machine), (new, new_machine) = times_of(given.old), times_of(given.new)
    if old_machine != new_machine:
        print("note: the runs were made on different machines", file=sys.stderr)
    shared = [name for name in old if name in new]
    if not shared:
        refuse("the runs have no benchmark in common")
    width = max(map(len, shared))
    slower = 0
    for name in shared:
        ratio = new[name] / old[name]
        is_slower = ratio > 1 + given.loss / 100
        slower += is_slower
        print(f"{name:{width}}  {old[name] / 1e6:12.3f} ms  {new[name] / 1e6:12.3f} ms  {ratio:6.2f}"
              + ("  slower" if is_slower else ""))
    for name in sorted(set(old) ^ set(new)):
        print(f"{name}: only in {'the old' if name in old else 'the new'} run")
    print(f"{len(shared)} benchmarks compared, {slower} more than {given.loss:g} % slower")
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())
