#!/usr/bin/env python3
"""Draws where the processor time of a run went: stages at the top, below them who called whom.

    flame_graph.py FILE.svg ventricle STUDY ...    runs the command on one thread under perf (Debian: linux-perf)

The width of a box is its share of the time. Boxes below half a percent are left out."""

import bisect
import collections
import html
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

PROGRAM = os.environ.get("DYNASURF_PROGRAM", str(pathlib.Path(__file__).parents[1] / "build/release/bin/dynasurf"))
LEAST_SHARE = 0.005
# What only hands work on: the scheduler, and what wraps a loop's body.
PASSED_OVER = re.compile(r"tbb::|std::_Function_handler|run_pieces|run_noted_pieces|parallel_(for|sum|max)|per_piece|"
                         r"^0x|^\[unknown\]|^_start|^__libc_start|^main$|StageClock|std::function|dynasurf::app::|"
                         r"^dynasurf::(ventricle|cloud)::(\(anonymous namespace\)::)?reconstruct")


def short(name):
    """Without arguments, templates and namespaces: mesh::simplify."""
    name = name.replace("(anonymous namespace)::", "").replace("dynasurf::", "")
    name = re.sub(r"\{lambda\(.*?\)#\d+\}", "lambda", name)
    name = re.sub(r"operator\(\)", "operator", name)
    for _ in range(8):
        name = re.sub(r"<[^<>]*>", "", name)
    name = name.split("(")[0]
    return re.sub(r"(::lambda(::operator)?)+$", "", name).strip().split(" ")[-1] or name


def record(arguments, folder):
    data, trace = folder / "perf.data", folder / "trace.json"
    done = subprocess.run(["perf", "record", "-q", "-e", "cpu-clock", "-F", "2000", "-k", "CLOCK_MONOTONIC", "--call-graph",
                           "dwarf,16384", "-o", data, PROGRAM, *arguments, "--threads", "1", "--out", folder / "out", "--trace", trace],
                          capture_output=True, text=True)
    if done.returncode not in (0, 3) or not trace.exists():
        sys.exit(f"{' '.join(arguments)}: {done.stderr.strip()}")
    text = subprocess.run(["perf", "script", "-i", data, "--no-inline", "-F", "tid,time,ip,sym"], capture_output=True,
                          text=True, errors="replace", check=True).stdout
    return text, json.loads(trace.read_text())["traceEvents"]


def stage_finder(events):
    """The stage at a time: the last to begin of those that are open."""
    stages = sorted((e["ts"], e["ts"] + e["dur"], e["name"]) for e in events if e["cat"] == "stage")
    begins = [stage[0] for stage in stages]

    def find(us):
        at = bisect.bisect(begins, us)
        return next((name for _, end, name in reversed(stages[:at]) if us <= end), "between stages")

    return find


def samples(text, stage_at):
    """Stacks from the stage downwards."""
    for sample in text.split("\n\n"):
        lines = sample.strip().splitlines()
        head = re.match(r"\s*\d+\s+(\d+\.\d+):", lines[0]) if lines else None
        if not head:
            continue
        frames = []
        for address, _, name in (line.strip().partition(" ") for line in reversed(lines[1:])):
            if address.startswith("ffff") and name != "[unknown]":
                frames.append("the system")
                break
            if name and not PASSED_OVER.search(name):
                frames.append(short(name))
        yield (stage_at(float(head[1]) * 1e6), *frames)


class Box:
    def __init__(self):
        self.count, self.inner = 0, collections.defaultdict(Box)


def tree_of(stacks):
    root = Box()
    for stack in stacks:
        box = root
        box.count += 1
        last = None
        for name in stack:
            if name == last:
                continue
            last = name
            box = box.inner[name]
            box.count += 1
    return root


def draw(root, title, path):
    width, row = 1200, 17
    boxes = []

    def place(box, x, depth):
        for name, inner in sorted(box.inner.items(), key=lambda item: -item[1].count):
            if inner.count < LEAST_SHARE * root.count:
                continue
            boxes.append((x, depth, inner.count, name))
            place(inner, x, depth + 1)
            x += inner.count

    place(root, 0, 0)
    height = row * (2 + max(depth for _, depth, _, _ in boxes)) + 14
    scale = width / root.count
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="11">',
           '<rect width="100%" height="100%" fill="white"/>',
           f'<text x="2" y="12">{html.escape(title)}: {root.count / 2000:.2f} s on one thread</text>']
    for x, depth, count, name in boxes:
        w, y = count * scale, 18 + row * depth
        colour = f"hsl({sum(map(ord, name)) % 50 + (200 if depth == 0 else 10)},70%,{78 if depth else 82}%)"
        fits = int((w - 4) / 5.6)
        own = name if name.endswith("::operator") else name.rpartition("::")[2]
        label = own if len(own) <= fits else own[: fits - 1] + "…" if fits > 4 else ""
        out.append(f'<g><title>{html.escape(name)} {100 * count / root.count:.1f} %</title>'
                   f'<rect x="{x * scale:.1f}" y="{y}" width="{max(0.5, w - 0.5):.1f}" height="{row - 1}" fill="{colour}"/>'
                   + (f'<text x="{x * scale + 3:.1f}" y="{y + 12}">{html.escape(label)}</text>' if label else "") + "</g>")
    path.write_text("\n".join(out + ["</svg>\n"]), encoding="utf-8")


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    arguments = sys.argv[2:]
    with tempfile.TemporaryDirectory(prefix="dynasurf-flame-") as folder:
        text, events = record(arguments, pathlib.Path(folder))
    root = tree_of(samples(text, stage_finder(events)))
    if root.count == 0:
        sys.exit("perf told nothing")
    draw(root, f"dynasurf {arguments[0]}", pathlib.Path(sys.argv[1]))


if __name__ == "__main__":
    main()
