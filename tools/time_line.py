#!/usr/bin/env python3
"""What the threads of a run did when, from a file that --trace wrote.

    time_line.py TRACE [--svg FILE]     what each stage took and how many threads were busy in it; a picture
    time_line.py TRACE --threads 4,8    of a run with --threads 1: what more threads would take

A thread is busy in a piece of a parallel loop; the first thread also outside of loops. More threads are simulated: the
pieces of a loop go to whichever thread is free, or, where that is sooner, the loops within pieces are shared too, which
takes at most (work - span) / threads + span (Brent 1974). What threads cost (caches, clocks, memory, the scheduler) is
not in it."""

import argparse
import collections
import html
import json
import sys

COLOURS = ("#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#bbbbbb", "#225555", "#997700", "#dd8855",
           "#88aadd", "#663333")
OTHER = "between"


class Event:
    def __init__(self, entry, zero):
        self.kind, self.name, self.thread = entry["cat"], entry["name"], entry["tid"]
        self.begin = entry["ts"] - zero
        self.end = self.begin + entry["dur"]
        self.loop = entry.get("args", {}).get("loop")
        self.inner = []  # on the same thread, one after the other


def read(path):
    """The outermost events of every thread, those of the thread that ran the program first."""
    with open(path, encoding="utf-8") as file:
        entries = json.load(file)["traceEvents"]
    if not entries:
        sys.exit(f"{path}: holds no event")
    zero = min(entry["ts"] for entry in entries)
    events = [Event(entry, zero) for entry in entries]
    threads = collections.defaultdict(list)
    # A piece that fills its loop lies within it, a stage around both.
    order = {"stage": 0, "loop": 1, "piece": 2}
    for event in sorted(events, key=lambda e: (e.begin, -e.end, order[e.kind])):
        threads[event.thread].append(event)
    first = max(events, key=lambda e: e.end).thread
    outermost = {}
    for thread in sorted(threads, key=lambda t: (t != first, t)):
        top, open_events = [], []
        for event in threads[thread]:
            while open_events and open_events[-1].end < event.end:
                open_events.pop()
            (open_events[-1].inner if open_events else top).append(event)
            open_events.append(event)
        outermost[thread] = top
    return outermost


def spans(events, begin, end, stage, busy, of_loop):
    """(begin, end, stage, busy) of one thread between two times. A loop's own time is spent waiting."""
    now = begin
    for event in events:
        if event.begin > now:
            yield now, event.begin, stage, busy
        inner = event.name if event.kind == "stage" else stage or of_loop.get(event.loop, "")
        yield from spans(event.inner, event.begin, event.end, inner, event.kind != "loop" and (busy or event.kind == "piece"),
                         of_loop)
        now = event.end
    if end > now:
        yield now, end, stage, busy


def stages_of_loops(events, stage, found):
    """The stage in which each loop runs; for those outside of stages the first that its pieces enter."""
    for event in events:
        inner = event.name if event.kind == "stage" else stage
        if event.kind == "loop":
            found[event.loop] = inner or first_stage(event)
        stages_of_loops(event.inner, inner, found)


def first_stage(event):
    for inner in event.inner:
        name = inner.name if inner.kind == "stage" else first_stage(inner)
        if name:
            return name
    return ""


def time_lines(threads):
    of_loop = {}
    for top in threads.values():
        stages_of_loops(top, "", of_loop)
    end = max(event.end for top in threads.values() for event in top)
    return [list(spans(top, 0, end, "", row == 0, of_loop)) for row, top in enumerate(threads.values())], end


def usage(lines, end):
    """Of each stage of the first thread: milliseconds, and the time for which all threads together were busy in them."""
    wall, busy = collections.Counter(), collections.Counter()
    for begin, stop, stage, _ in lines[0]:
        wall[stage or OTHER] += stop - begin
    edges = [(begin, stop, stage or OTHER) for begin, stop, stage, _ in lines[0]]
    for line in lines:
        at = 0
        for begin, stop, _, is_busy in line:
            while at + 1 < len(edges) and edges[at][1] <= begin:
                at += 1
            n = at
            while is_busy and n < len(edges) and edges[n][0] < stop:
                busy[edges[n][2]] += max(0, min(stop, edges[n][1]) - max(begin, edges[n][0]))
                n += 1
    print(f"{'stage':28} {'ms':>8} {'busy threads':>13}")
    for stage, us in wall.most_common():
        if us > 0.002 * end:
            print(f"{stage:28} {us / 1e3:8.1f} {busy[stage] / us:13.2f}")
    print(f"{'all':28} {end / 1e3:8.1f} {sum(busy.values()) / end:13.2f}")


def svg(lines, end, path):
    width, height, left, legend = 1000, 34, 70, 130
    took = collections.Counter()
    for line in lines:
        for begin, stop, stage, busy in line:
            took[stage or OTHER] += (stop - begin) * busy
    names = [name for name, us in took.most_common() if us > 0.004 * end][: len(COLOURS)]
    colour = {name: COLOURS[n % len(COLOURS)] for n, name in enumerate(names)}
    x = lambda us: left + us / end * (width - left - 10)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {len(lines) * (height + 8) + legend}" '
           'font-family="sans-serif" font-size="12">', '<rect width="100%" height="100%" fill="white"/>']
    for row, line in enumerate(lines):
        y = 10 + row * (height + 8)
        out.append(f'<text x="4" y="{y + height / 2 + 4}">thread {row + 1}</text>')
        out.append(f'<rect x="{left}" y="{y}" width="{width - left - 10}" height="{height}" fill="#eee"/>')
        merged = []
        for begin, stop, stage, busy in line:
            if not busy:
                continue
            if merged and merged[-1][2] == stage and begin - merged[-1][1] < end / 4000:
                merged[-1][1] = stop
            else:
                merged.append([begin, stop, stage])
        for begin, stop, stage in merged:
            if stop - begin > end / 4000:
                out.append(f'<rect x="{x(begin):.1f}" y="{y}" width="{x(stop) - x(begin):.1f}" height="{height}" '
                           f'fill="{colour.get(stage or OTHER, "#888")}"/>')
    y = 10 + len(lines) * (height + 8)
    step = next(s for s in (10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10**9) if end / 1e3 / s <= 10)
    for ms in range(0, int(end / 1e3) + 1, step):
        out.append(f'<text x="{x(1e3 * ms):.1f}" y="{y + 10}" text-anchor="middle">{ms}</text>')
    out.append(f'<text x="4" y="{y + 10}">ms</text>')
    for n, name in enumerate(names):
        at_x, at_y = left + 240 * (n % 4), y + 28 + 22 * (n // 4)
        out.append(f'<rect x="{at_x}" y="{at_y}" width="14" height="14" fill="{colour[name]}"/>'
                   f'<text x="{at_x + 20}" y="{at_y + 12}">{html.escape(name)} {took[name] / 1e3:.0f} ms</text>')
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(out + ["</svg>\n"]))


def work_and_span(event):
    """Microseconds on one thread, and on as many as there can be work for."""
    inner = [work_and_span(e) for e in event.inner]
    work = event.end - event.begin
    own = max(0.0, work - sum(w for w, _ in inner))
    spans_inside = [s for _, s in inner]
    return work, own + (max(spans_inside, default=0.0) if event.kind == "loop" else sum(spans_inside))


def simulated(event, threads):
    """Microseconds that an event of a run on one thread takes on so many."""
    own = max(0.0, event.end - event.begin - sum(e.end - e.begin for e in event.inner))
    if event.kind != "loop":
        return own + sum(simulated(e, threads) for e in event.inner)
    free = [0.0] * threads
    for piece in event.inner:
        free[free.index(min(free))] += piece.end - piece.begin
    work, span = work_and_span(event)
    return own + min(max(free), (work - own - span) / threads + span)


def scaling(threads, counts):
    if len(threads) > 1:
        sys.exit("the trace has several threads; more are simulated from a run with --threads 1")
    (top,) = threads.values()
    end = max(event.end for event in top)
    stages = collections.defaultdict(lambda: [0.0] * (1 + len(counts)))
    between = end - sum(event.end - event.begin for event in top)
    for event in top:
        name = event.name if event.kind == "stage" else first_stage(event) or OTHER
        times = [event.end - event.begin] + [simulated(event, count) for count in counts]
        stages[name] = [a + b for a, b in zip(stages[name], times)]
    stages[OTHER] = [a + between for a in stages[OTHER]]
    print(f"{'stage, ms on threads':28}" + "".join(f"{count:>9}" for count in [1, *counts]))
    for name, times in [*sorted(stages.items(), key=lambda s: -s[1][0]), ("all", [sum(t) for t in zip(*stages.values())])]:
        print(f"{name:28}" + "".join(f"{us / 1e3:9.1f}" for us in times))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("trace")
    parser.add_argument("--svg", help="draw the time line to this file")
    parser.add_argument("--threads", help="numbers of threads to simulate, with commas between them")
    arguments = parser.parse_args()
    threads = read(arguments.trace)
    if arguments.threads:
        scaling(threads, [int(count) for count in arguments.threads.split(",")])
        return
    lines, end = time_lines(threads)
    usage(lines, end)
    if arguments.svg:
        svg(lines, end, arguments.svg)


if __name__ == "__main__":
    main()
