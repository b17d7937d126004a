#!/usr/bin/env python3
"""Scans of many bodies through `dynasurf cloud`: is what is wrong told, and what is right not doubted?"""
import argparse
import concurrent.futures
import hashlib
import itertools
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

import bodies

HERE = pathlib.Path(__file__).resolve().parent
PHANTOMS = {"sphere": 0, "ellipsoid": 0, "torus": 1, "two_torus": 2, "cube": 0, "plate": 0, "spring": 0, "vase": 0, "blobs": 0}
# name: points, noise in % of the diagonal, missing in %, outliers in %
CONDITIONS = {"clean": (20000, 0, 0, 0), "sparse": (4000, 0, 0, 0), "noise": (20000, 0.5, 0, 0), "hole": (20000, 0, 15, 0),
              "outliers": (20000, 0, 0, 1)}
MEASURES = {"points_off_percent": 1, "points_off_mean_ratio": 1, "points_left_out_percent": 1, "biased_percent": 1, "made_up_percent": 1,
            "made_up_largest_percent": 1, "unfaced_points": 1, "turned_percent": 1, "gaps_percent": 1, "firm_percent": -1}
REFERENCE = 80000
NEW, FRESH = ({name for name, *_ in some} for some in (bodies.newest(), bodies.freshest()))


def read_ply(path):
    """Vertices and triangles of a binary PLY of this program, with doubles first in a vertex."""
    head, data = path.read_bytes().split(b"end_header\n", 1)
    kinds, counts, width = {"double": 8, "float": 4, "uchar": 1}, {}, 0
    for line in head.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            counts[words[1]] = int(words[2])
        elif words[0] == "property" and words[1] != "list":
            width += kinds[words[1]]
    rows = numpy.frombuffer(data, numpy.uint8, counts["vertex"] * width).reshape(-1, width)
    faces = numpy.frombuffer(data, numpy.uint8, counts["face"] * 13, counts["vertex"] * width).reshape(-1, 13)
    return rows[:, :24].copy().view(float), faces[:, 1:].copy().view(numpy.int32)


def read_off(path):
    words = " ".join(line.split("#")[0] for line in path.read_text().splitlines()).split()
    count, faces = int(words[1]), int(words[2])
    places = numpy.array(words[4:4 + 3 * count], float).reshape(-1, 3)
    corners = numpy.array(words[4 + 3 * count:4 + 3 * count + 4 * faces], int).reshape(-1, 4)
    return places, corners[:, 1:]


def parts_and_handles(vertices, triangles):
    """Of a closed surface; handles of an open one are None."""
    edges, uses = numpy.unique(numpy.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), 1), axis=0, return_counts=True)
    graph = coo_matrix((numpy.ones(len(edges)), edges.T), (len(vertices),) * 2)
    parts = int(connected_components(graph)[0])
    return parts, None if (uses == 1).any() else int(parts - (len(vertices) - len(edges) + len(triangles)) // 2)


def points_of_mesh(vertices, triangles, count, seed):
    random = numpy.random.default_rng(seed)
    a, b, c = (vertices[triangles[:, n]] for n in range(3))
    area = numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1)
    t = random.choice(len(triangles), count, p=area / area.sum())
    u, v = random.random((2, count, 1))
    u, v = numpy.where(u + v > 1, 1 - u, u), numpy.where(u + v > 1, 1 - v, v)
    return a[t] + u * (b[t] - a[t]) + v * (c[t] - a[t])


def scan(surface, condition, seed):
    """Some of the points of a dense surface, and what goes wrong with them."""
    count, noise, missing, outliers = CONDITIONS[condition]
    random = numpy.random.default_rng(seed)
    low, high = surface.min(0), surface.max(0)
    diagonal = numpy.linalg.norm(high - low)
    points = surface[random.permutation(len(surface))[:count]]
    if missing:
        far = numpy.linalg.norm(points - points[0], axis=1)
        points = points[far > numpy.quantile(far, missing / 100)]
    points = points + noise / 100 * diagonal * random.normal(size=points.shape)
    stray = low + (high - low) * random.random((int(len(points) * outliers / 100), 3))
    return numpy.concatenate([points, stray])


def compared(mesh, surface):
    """Mean and largest distance of both ways in % of the diagonal; what the density of samples adds is taken off."""
    diagonal = numpy.linalg.norm(surface.max(0) - surface.min(0))
    samples = points_of_mesh(*mesh, REFERENCE, 1)
    there, back = cKDTree(samples).query(surface)[0], cKDTree(surface).query(samples)[0]
    floor = 0.5 * numpy.sqrt(area_of(mesh) / REFERENCE)
    mean = max(0, 0.5 * (there.mean() + back.mean()) - floor)
    return 100 * mean / diagonal, 100 * max(there.max(), back.max()) / diagonal


def area_of(mesh):
    a, b, c = (mesh[0][mesh[1][:, n]] for n in range(3))
    return 0.5 * numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1).sum()


def all_bodies(arguments):
    """(name, what makes its dense surface, the numbers of parts that are right and the handles: None of open ones)"""
    for name, handles in PHANTOMS.items():
        yield f"phantom {name}", (lambda name=name: phantom_surface(arguments.program, name)), ((1,), handles)
    for name, value, parts, handles in itertools.chain(bodies.solids(), bodies.later(), bodies.latest(), bodies.newest(),
                                                        bodies.freshest()):
        yield name, (lambda value=value: bodies.points_on(value, REFERENCE, 7)), (parts, handles)
    for name, value, keep in bodies.sheets():
        yield name, (lambda value=value, keep=keep: bodies.points_on(value, REFERENCE, 7, keep)), ((1,), None)
    for path in arguments.mesh:
        mesh = read_off(path)
        parts, handles = parts_and_handles(*mesh)
        yield f"file {path.stem}", (lambda mesh=mesh: points_of_mesh(*mesh, REFERENCE, 7)), ((parts,), handles)


def phantom_surface(program, shape):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "p"
        subprocess.run([program, "phantom", "cloud", "--out", out, "--set", f"shape={shape}", "--set", "points=10"], check=True,
                       capture_output=True)
        return points_of_mesh(*read_ply(out / "truth" / "surface.ply"), REFERENCE, 7)


def judge(arguments, surface, condition, truth):
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        numpy.savetxt(folder / "cloud.xyz", scan(surface, condition, 11), "%.9g")
        done = subprocess.run([arguments.program, "cloud", folder / "cloud.xyz", "--out", folder / "r", "--triangles", "5120",
                               "--quiet", "--threads", "1"], capture_output=True, text=True)
        if done.returncode not in (0, 3):
            return {"verdict": "refused", "error": done.stderr.strip()}
        results = json.loads((folder / "r" / "results.json").read_text())
        mesh = read_ply(next((folder / "r" / "meshes").iterdir()))
        mean, largest = compared(mesh, surface)
        parts, handles = parts_and_handles(*mesh)
    may_have, has = truth
    wrong = [why for why, is_so in (("closed" if has is None else "open", (has is None) != (handles is None)),
                                    ("parts", parts not in may_have), ("handles", None not in (has, handles) and handles != has),
                                    ("mean", mean > 0.5), ("largest", largest > 10)) if is_so]
    return {"verdict": results["verdict"], "wrong": wrong, "mean": mean, "largest": largest, "parts": parts, "handles": handles,
            "support": results["support"], "warnings": sorted({n["code"] for n in results["notes"] if n["severity"] != "info"}),
            "commit": results["provenance"]["commit"], "seconds": sum(results["timings_s"].values())}


def run_body(arguments, name, make, truth, wanted, stamp):
    kept = arguments.rows.with_suffix("") / f"{name.replace(' ', '_')}.npy"
    if kept.exists():
        surface = numpy.load(kept)
    else:
        surface = make()
        kept.parent.mkdir(parents=True, exist_ok=True)
        numpy.save(kept, surface)
    return [{"stamp": stamp, "body": name, "condition": c, **judge(arguments, surface, c, truth)} for c in wanted]


def share(count, of):
    return f"{count} of {of} ({100 * count / max(of, 1):.0f} %)"


def summary(rows):
    lines = ["| | scans | wrong | of them not ok | right | of them flagged |", "|---|---|---|---|---|---|"]
    tell = lambda label, some: lines.append(
        f"| {label} | {len(some)} | {sum(map(bool, wrongs(some)))} | " +
        share(sum(w and r["verdict"] != "ok" for w, r in zip(wrongs(some), some)), sum(map(bool, wrongs(some)))) +
        f" | {sum(not w for w in wrongs(some))} | " +
        share(sum(not w and r["verdict"] != "ok" for w, r in zip(wrongs(some), some)), sum(not w for w in wrongs(some))) + " |")
    groups = {"bodies the limits were chosen on": [r for r in rows if r["body"] not in NEW | FRESH],
              "bodies that no limit was chosen on": [r for r in rows if r["body"] in NEW],
              "bodies never looked at": [r for r in rows if r["body"] in FRESH]}
    for label, some in groups.items():
        tell(label, some)
        for condition in CONDITIONS:
            tell(f"{label}, {condition}", [r for r in some if r["condition"] == condition])
    return lines


def wrongs(rows):
    return [bool(r.get("wrong", ["refused"])) for r in rows]


def limits(rows):
    """Of each measure, on the bodies to choose on: what 99 % of the right scans stay within, and how many wrong ones do not."""
    chosen = [r for r in rows if r["body"] not in NEW | FRESH and "support" in r]
    right, wrong = [r for r in chosen if not r["wrong"]], [r for r in chosen if r["wrong"]]
    lines = []
    for measure, sign in MEASURES.items():
        values = sorted(sign * r["support"][measure] for r in right)
        limit = values[int(0.99 * (len(values) - 1))]
        beyond = sum(sign * r["support"][measure] > limit for r in wrong)
        spread = ", ".join(f"{sign * values[int(q * (len(values) - 1))]:.3g}" for q in (0.5, 0.9, 0.95, 0.98, 1))
        lines.append(f"{measure}: 99 % of the right within {sign * limit:.3g}, beyond it {share(beyond, len(wrong))} of the wrong; "
                     f"right at 50, 90, 95, 98, 100 %: {spread}")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default="dynasurf")
    parser.add_argument("--rows", type=pathlib.Path, default=pathlib.Path("cloud_bank.jsonl"), help="rows so far; a run goes on there")
    parser.add_argument("--mesh", type=pathlib.Path, action="append", default=[], help="closed OFF file of triangles: one more body")
    parser.add_argument("--only", default="", help="bodies whose name holds this")
    parser.add_argument("--every", type=int, default=1, help="every so many of the bodies")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--limits", action="store_true", help="tell what limits the bodies to choose on ask for")
    parser.add_argument("--out", type=pathlib.Path, help="write the table here")
    arguments = parser.parse_args()
    version = subprocess.run([arguments.program, "--version"], capture_output=True, text=True, check=True).stdout.splitlines()[0]
    source = b"".join((HERE / name).read_bytes() for name in ("bodies.py", "run.py"))
    stamp = f"{version}, bank {hashlib.sha256(source).hexdigest()[:12]}"
    rows = [json.loads(line) for line in arguments.rows.read_text().splitlines()] if arguments.rows.exists() else []
    if any(row["stamp"] != stamp for row in rows):
        sys.exit(f"{arguments.rows}: holds rows of another program or bank; expected those of {stamp}")
    # Mixed, so that a run that was stopped early has bodies of all kinds.
    everything = sorted(all_bodies(arguments), key=lambda body: hashlib.sha256(body[0].encode()).hexdigest())
    done = {(row["body"], row["condition"]) for row in rows}
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool, arguments.rows.open("a") as file:
        asked = []
        for name, make, truth in everything[::arguments.every]:
            wanted = [c for c in CONDITIONS if (name, c) not in done and arguments.only in name]
            if wanted:
                asked.append(pool.submit(run_body, arguments, name, make, truth, wanted, stamp))
        for future in concurrent.futures.as_completed(asked):
            for row in future.result():
                rows.append(row)
                file.write(json.dumps(row) + "\n")
            file.flush()
            print(f"{len(rows)} scans", file=sys.stderr)
    text = "\n".join([stamp, f"{len({r['body'] for r in rows})} bodies, {len(rows)} scans", ""] + summary(rows))
    if arguments.limits:
        text += "\n\n" + "\n".join(limits(rows))
    print(text)
    if arguments.out:
        arguments.out.write_text(text + "\n")


if __name__ == "__main__":
    main()
