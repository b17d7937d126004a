#!/usr/bin/env python3
"""Time and memory of `dynasurf cloud` against the points of a scan: a table and a picture."""
import argparse
import json
import os
import pathlib
import subprocess
import tempfile
import time

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams.update({"svg.hashsalt": "dynasurf", "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 9})
from matplotlib import pyplot  # noqa: E402

POINTS = [10 ** 4, 10 ** 5, 10 ** 6, 10 ** 7]
SHAPES = {"vase": "#1f6f8b", "spring": "#c0562f"}


def measured(command):
    """Seconds of wall clock and of the processors, and the largest memory, of a program."""
    begin = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = status
    if status != 0:
        raise SystemExit(f"{' '.join(map(str, command))}: status {status}")
    return time.perf_counter() - begin, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024


def rows_of(program, runs):
    for shape in SHAPES:
        for count in POINTS:
            with tempfile.TemporaryDirectory() as folder:
                folder = pathlib.Path(folder)
                subprocess.run([program, "phantom", "cloud", "--out", folder / "scan", "--set", f"shape={shape}", "--set", f"points={count}"],
                               check=True, stdout=subprocess.DEVNULL)
                all_runs = [measured([program, "cloud", folder / "scan/cloud.ply", "--out", folder / f"r{n}", "--quiet"]) for n in range(runs)]
                commit = json.loads((folder / "r0/results.json").read_text())["provenance"]["commit"]
                peak = max(run[2] for run in all_runs)
                yield {"shape": shape, "points": count, "seconds": min(run[0] for run in all_runs), "cpu": min(run[1] for run in all_runs),
                       "peak_mb": peak / 1e6, "commit": commit}


def draw(rows, path):
    figure, panels = pyplot.subplots(1, 2, figsize=(7, 2.8), constrained_layout=True)
    for panel, key, label in zip(panels, ("seconds", "peak_mb"), ("seconds", "memory, MB")):
        for shape, colour in SHAPES.items():
            some = [row for row in rows if row["shape"] == shape]
            panel.loglog([row["points"] for row in some], [row[key] for row in some], "o-", color=colour, label=shape, markersize=4)
        last = [row for row in rows if row["points"] == POINTS[-1]]
        steep = max(row[key] for row in last)
        panel.loglog(POINTS[1:], [steep * n / POINTS[-1] for n in POINTS[1:]], ":", color="#888", label="proportional")
        panel.set_xlabel("points")
        panel.set_title(label)
        panel.grid(True, which="major", color="#ddd")
    panels[0].legend(frameon=False)
    figure.savefig(path, metadata={"Date": None, "Creator": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", required=True)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--out", type=pathlib.Path, required=True, help="the table")
    parser.add_argument("--picture", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    rows = list(rows_of(arguments.program, arguments.runs))
    text = [f"dynasurf (commit {rows[0]['commit'][:12]}), two threads, least of {arguments.runs} runs, levels of 5120, 1280, 320 triangles", "",
            "| shape | points | seconds | processor seconds | largest memory, MB | bytes a point |", "|---|---|---|---|---|---|"]
    for row in rows:
        text.append(f"| {row['shape']} | {row['points']:,} | {row['seconds']:.2f} | {row['cpu']:.2f} | {row['peak_mb']:.0f} | "
                    f"{1e6 * row['peak_mb'] / row['points']:.0f} |")
    arguments.out.write_text("\n".join(text) + "\n")
    draw(rows, arguments.picture)


if __name__ == "__main__":
    main()
