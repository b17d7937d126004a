#!/usr/bin/env python3
"""Inserts measured numbers into documents from the result files that experiments/ keeps.

    figures.py [--update] [FILE.md...]      without files: all documents

Two kinds of markers; what stands behind them must be what the files say, and --update writes it:

    <!-- figure FILE KEY [FORMAT] -->VALUE<!-- end -->    one number: KEY is a path (a.b.0) in a JSON file; in any other
                                                         text it is a line's label and a column: `all:2`, or behind a
                                                         headline `Mean F1 > mlc:1`
    <!-- results NAME -->TABLE<!-- end -->               a table, made by the function `NAME` below
"""

import argparse
import json
import pathlib
import re
import statistics
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
MARKER = re.compile(r"(<!-- (figure|results) ([^>]*?) -->)(.*?)(<!-- end -->)", re.DOTALL)
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?")


def text_of(root, name):
    return (root / "experiments" / name).read_text()


# One number.


def number_in_line(text, key):
    """Number `column` (from 1) of the first line that is a label and numbers; with `SECTION > ` only behind that text."""
    section, _, line_and_column = key.rpartition(" > ")
    label, _, column = line_and_column.rpartition(":")
    for line in text[text.index(section):].splitlines():
        plain = " ".join(line.strip("| ").replace("|", " ").split())
        numbers = NUMBER.findall(plain[len(label):])
        if plain.startswith(label) and NUMBER.match(plain[len(label):].strip()):
            return numbers[int(column) - 1]
    raise LookupError(f"no line begins with '{label}' and a number")


def figure(root, arguments):
    name, rest = arguments.split(" ", 1)
    key, _, form = rest.partition(" %")
    text = (root / name).read_text()
    if name.endswith(".json"):
        value = json.loads(text)
        for step in key.split("."):
            value = value[int(step) if isinstance(value, list) else step]
    else:
        value = number_in_line(text, key)
    return f"%{form}" % float(value) if form else str(value)


# Tables. Each takes the root of the repository and gives lines of Markdown.


def markdown(header, rows):
    return [f"| {' | '.join(header)} |", "|" + "---|" * len(header), *(f"| {' | '.join(row)} |" for row in rows)]


def mean_and_sd(values):
    return f"{statistics.mean(values):+.1f} ± {statistics.stdev(values):.1f}" if len(values) > 1 else f"{values[0]:+.1f}"


def rms(values):
    return f"{(sum(v * v for v in values) / len(values)) ** 0.5:.1f}"


class Patient:
    """A line of experiments/unbiased_200: truth, reading and standard deviation of five numbers, and more."""

    def __init__(self, line):
        words = line.split()
        self.kind, self.number, self.defect, self.gut = words[0], int(words[1]), words[2] == "1", words[3] == "1"
        numbers = [float(word) for word in words[4:]]
        self.told = numbers[0]
        self.fwhm, self.edv, self.esv, self.ef, self.wall = (numbers[1 + 3 * i:4 + 3 * i] for i in range(5))
        self.cycle, self.distance, self.edge_edv, self.edge_ef, self.seconds = numbers[16:21]


def held_out(root, kind):
    rows = map(Patient, text_of(root, "unbiased_200/results.txt").splitlines())
    return [p for p in rows if p.kind == kind and p.edv[1] > 0]


def percent_off(readings):
    return [100 * (value / truth - 1) for truth, value, _ in readings]


def points_off(readings):
    return [value - truth for truth, value, _ in readings]


def covered(readings):
    """The share of the 90 % intervals that hold the truth."""
    return f"{100 * sum(abs(value - truth) <= 1.645 * sd for truth, value, sd in readings) / len(readings):.0f}"


GROUPS = {
    "all": lambda p: True,
    "60 mL and more, no defect": lambda p: p.edv[0] >= 60 and not p.defect,
    "with a defect": lambda p: p.defect,
    "below 60 mL": lambda p: p.edv[0] < 60,
}


def fit_rows(root, kind, label):
    for group, chosen in GROUPS.items():
        some = [p for p in held_out(root, kind) if chosen(p)]
        yield [f"{label}, {group}", str(len(some)), mean_and_sd(percent_off([p.edv for p in some])),
               mean_and_sd(percent_off([p.esv for p in some])), mean_and_sd(points_off([p.ef for p in some])),
               mean_and_sd(percent_off([p.wall for p in some])), f"{statistics.mean(p.distance for p in some):.2f}",
               " / ".join(covered([getattr(p, what) for p in some]) for what in ("edv", "esv", "ef", "wall")),
               mean_and_sd([100 * (p.edge_edv / p.edv[0] - 1) for p in some]),
               f"{rms(points_off([p.ef for p in some]))} / {rms([p.edge_ef - p.ef[0] for p in some])}"]


def fit_held_out(root):
    return markdown(["patients", "n", "EDV %", "ESV %", "EF points", "wall %", "distance mm", "coverage % of EDV / ESV / EF / wall",
                     "edge EDV %", "RMS of EF, fit / edge"], [*fit_rows(root, "plain", "model"), *fit_rows(root, "unlike", "mismatch")])


def point_spread(root):
    rows = []
    for kind, label in (("plain", "model, width given exactly"), ("unlike", "mismatch, width given 10 % wrong"),
                        ("untold", "model, width not given")):
        some = held_out(root, kind)
        rows.append([label, str(len(some)), mean_and_sd(percent_off([p.fwhm for p in some])), covered([p.fwhm for p in some])])
    return markdown(["patients", "n", "estimated width, error %", "coverage %"], rows)


def edge_bias(root):
    cells, text = {}, text_of(root, "volume_bias/results.txt")
    for heart, blur, edv, esv, ef in re.findall(
            r"^\| (\w+), (\d+) mm \|[^|]*\|[^|]*\| (\S+) % \| (\S+) % \| (\S+) \|", text, re.MULTILINE):
        cells[heart, blur] = f"{edv} / {esv} / {ef}"
    blurs = sorted({blur for _, blur in cells}, key=int)
    return markdown(["heart"] + [f"{blur} mm" for blur in blurs],
                    [[heart] + [cells[heart, blur] for blur in blurs] for heart in ("normal", "small", "dilated")])


def located(root):
    text = text_of(root, "borders_200/results.txt")
    reporting = re.search(r"^Reporting half.*?\n(.*?)(?:\n\n|\Z)", text, re.DOTALL | re.MULTILINE)[1]
    names = {"both surfaces in all gates": "both surfaces in all gates", "wrong  ": "wrong results",
             "wrong ones flagged": "wrong results flagged", "right ones flagged": "right results flagged",
             "ejection fraction error, points": "ejection fraction, error in points", "long axis, degrees": "long axis, degrees",
             "centre, mm": "centre, mm", "valve plane, mm": "valve plane, mm", "division slice, slices": "division slice, slices",
             "worst border, mm": "worst border, mm"}
    rows = []
    for key, name in names.items():
        found = re.search(rf"^ *{re.escape(key)}(?:\(mean of gates\)| )*(.*)$", reporting, re.MULTILINE)[1]
        value = re.sub(r", within.*", "", " ".join(found.split()))
        rows.append([name, value.replace("+-", "±").replace(".0 %", " %")])
    return markdown(["", "reporting half"], rows)


def division_slice(root):
    rows = re.findall(r"^(\w+ half, [^:]*): (\d+) gates\n.*?within 1: *([\d.]+) %.*\n.*?within 1: *([\d.]+) %",
                      text_of(root, "division_slice/results.txt"), re.MULTILINE)
    return markdown(["gates", "n", "inner border alone, within one slice %", "division slice, within one slice %"],
                    [list(row) for row in rows])


def segments(root):
    # The first table of the file is the one over all patients.
    table = re.search(r"^\| number .*?(?=\n\n)", text_of(root, "regional_truth/results.txt"), re.DOTALL | re.MULTILINE)[0]
    rows = [[cell.strip().replace("+-", "±") for cell in line.strip("|").split("|")] for line in table.splitlines()[2:]]
    rows = [[name, n, edge, edge_right, fit, right, told if told == "-" else told.split(", ")[1]]
            for name, n, edge, edge_right, fit, right, told in rows]
    return markdown(["number", "n", "edge: error", "right %", "fit: error", "right %", "coverage %"], rows)


def modalities(root):
    images, order = {}, []
    for line in text_of(root, "modalities/results.txt").splitlines()[2:]:
        match = re.match(r"(.+?) +(usual|small|wide) (.*)", line)
        if not match:
            continue
        if match[1] not in order:
            order.append(match[1])
        images.setdefault(match[1], []).append(match[3].split())

    def span(rows, column):
        values = [float(row[column]) for row in rows if row[column] != "-"]
        if not values:
            return "-"
        return f"{min(values):+.1f} to {max(values):+.1f}"

    lines = []
    for image in order:
        rows = images[image]
        held = "-" if rows[0][0] == "-" else f"{sum(int(row[4]) for row in rows)} of {4 * len(rows)}"
        lines.append([image] + [span(rows, column) for column in range(4)] + [held] + [span(rows, 7), span(rows, 9)])
    return markdown(["image", "EDV %", "ESV %", "EF points", "wall %", "in 90 %", "edges: EDV %", "EF points"], lines)


def clouds(root):
    text, rows = text_of(root, "cloud_shapes/results.txt"), []
    for method in ("shaped", "faithful"):
        for condition in ("clean", "noise 0.5 %", "a fifth missing"):
            table = text.split(f"## {method}, {condition}\n")[1].split("\n## ")[0]
            cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines() if line.startswith("| ")][1:]
            row = [f"`{method}`", condition]
            for triangles in ("5120", "1280", "320"):
                level = [cell for cell in cells if cell[4] == triangles]
                distances = [float(cell[6]) for cell in level]
                row.append(f"{sum(cell[5] == 'yes' for cell in level)} of {len(level)}")
                row.append(f"{statistics.median(distances):.2g} ({max(distances):.2g})")
            rows.append(row + [f"{min(float(cell[9]) for cell in cells):.1f}"])
    header = ["method", "scan", "5120: valid", "distance %", "1280: valid", "distance %", "320: valid", "distance %", "least angle"]
    return markdown(header, rows)


def missing_data(root):
    text, columns = text_of(root, "missing_data/results.txt"), {}
    for empty, preset, body in re.findall(r"^empty: (\w+), preset (\w+)\n.*\n((?:.+\n?)+)", text, re.MULTILINE):
        name = preset if preset in ("thesis", "edges") else "fit"
        columns[name, empty] = {line.split()[0]: line.split() for line in body.splitlines()}
    order = [(name, empty) for name in ("thesis", "edges", "fit") for empty in ("sector", "apex")]

    def cell(column, part):
        _, _, share, _, off, *_ = columns[column][part]
        return share if off == "-" else f"{share} ({off})"

    rows = [[f"{part} %", columns[order[0]][part][5], *(cell(column, part) for column in order)] for part in ("10", "32", "53")]
    return markdown(["empty", "published"] + [", ".join(column) for column in order], rows)


TABLES = [clouds, division_slice, edge_bias, fit_held_out, located, missing_data, modalities, point_spread,
          segments]


def fresh(root, match):
    if match[2] == "figure":
        return match[1] + figure(root, match[3]) + match[5]
    table = {f.__name__: f for f in TABLES}[match[3]](root)
    return match[1] + "\n" + "\n".join(table) + "\n" + match[5]


def check(path, root, update):
    """Complaints about one document; with `update` it is written anew instead."""
    text, complaints = path.read_text(), []

    def replaced(match):
        try:
            made = fresh(root, match)
        except (LookupError, ValueError, OSError, TypeError) as error:
            complaints.append(f"{path.relative_to(root)}: {match[2]} {match[3]}: {error}")
            return match[0]
        if made != match[0] and not update:
            complaints.append(f"{path.relative_to(root)}: {match[2]} {match[3]} is not what the file says; run tools/figures.py --update")
        return made

    written = MARKER.sub(replaced, text)
    if update and written != text:
        path.write_text(written)
    return complaints


def documents(root):
    skipped = {"build", "demo", "node_modules", ".git"}
    return [p for p in sorted(root.rglob("*.md")) if not skipped & set(p.relative_to(root).parts)]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--update", action="store_true")
    parser.add_argument("--root", type=pathlib.Path, default=ROOT)
    parser.add_argument("files", nargs="*", type=pathlib.Path)
    arguments = parser.parse_args()
    root = arguments.root.resolve()
    failures = [line for path in arguments.files or documents(root) for line in check(path.resolve(), root, arguments.update)]
    print("\n".join(failures) if failures else "all figures are those of the result files")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
