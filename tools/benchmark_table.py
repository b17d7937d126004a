#!/usr/bin/env python3
"""The table of a run of the benchmarks: ours beside the peers of the same run.

    benchmark_table.py RESULTS

RESULTS is a folder of Google Benchmark's JSON files, as `./dev bench` leaves them in build/bench/results. Of several
repetitions the fastest counts. Peers that were not installed are left out.
"""

import pathlib
import sys

from compare_benchmarks import NANOSECONDS, read, refuse

FIELDS = {"64": "64 x 64 x 23", "62": "62^3", "128": "128^3", "256": "256^3"}
BODIES = {"0": "vase", "1": "spring", "2": "rabbit"}


def rows_of(folder):
    """The fastest row of each benchmark by its name, and the machine."""
    rows, machine = {}, ""
    for file in sorted(folder.glob("*.json")):
        result = read(file)
        context = result["context"]
        machine = f"{context['host_name']}, {context['num_cpus']} processors"
        for row in result["benchmarks"]:
            if row.get("run_type", "iteration") != "iteration" or row.get("error_occurred"):
                continue
            row["ms"] = row["real_time"] * NANOSECONDS[row["time_unit"]] / 1e6
            # How a time was taken is no part of what it is of.
            name = "/".join(part for part in row["name"].split("/") if part not in ("real_time", "process_time"))
            if name not in rows or row["ms"] < rows[name]["ms"]:
                rows[name] = row
    if not rows:
        refuse(f"{folder} holds no *.json; expected results of ./dev bench")
    return rows, machine


def time_text(ms):
    return f"{ms:.3g} ms" if ms < 1000 else f"{ms / 1000:.3g} s"


def beside(rows, title, ours, peers, note=lambda row: ""):
    """Lines of one task: ours, then each peer with how many times as long it took. Some do several steps in a row."""
    if ours not in rows:
        return
    print(f"{title:44} {'ours':26} {time_text(rows[ours]['ms']):>10}{'':8}{note(rows[ours])}")
    for name, peer in peers:
        if peer in rows:
            ms = rows[peer]["ms"] / rows[peer].get("steps", 1)
            print(f"{'':44} {name:26} {time_text(ms):>10}{ms / rows[ours]['ms']:7.3g}x{note(rows[peer])}")


def print_fields(rows):
    for size, words in FIELDS.items():
        beside(rows, f"steady field, {words}, to 1e-3, one thread", f"steady/size:{size}/threads:1/digits:3",
               [("one explicit step", f"explicit_steps/size:{size}/threads:1"),
                ("one step of ITK", f"itk_steps/size:{size}/threads:1"),
                ("hypre, CG with PFMG", f"hypre/size:{size}")])


def print_clouds(rows):
    def off(row):
        return f"   {row['off']:.3f} % off"

    for number, body in BODIES.items():
        beside(rows, f"100,000 points of a {body}, one thread", f"cloud_to_mesh/body:{number}/threads:1",
               [("two threads", f"cloud_to_mesh/body:{number}/threads:2"),
                ("CGAL, alpha wrap", f"cgal_alpha_wrap/body:{number}"),
                ("Open3D, Poisson", f"open3d_poisson/body:{number}")], off)


def print_studies(rows):
    for name, words in (("fitted", "study, fitted"), ("steady_fields", "study, edges alone"),
                        ("thesis_fields", "study, edges, explicit fields")):
        beside(rows, f"{words}, one thread", f"{name}/threads:1", [("two threads", f"{name}/threads:2")])


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    rows, machine = rows_of(pathlib.Path(sys.argv[1]))
    print(f"{machine}; times of the peers also as multiples of ours\n")
    print_fields(rows)
    print_clouds(rows)
    print_studies(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
