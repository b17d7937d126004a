#!/usr/bin/env python3
"""Virtual patients seen by the camera and reconstructed: are volumes, EF and wall right, and do the intervals hold?

usage: run.py KINDS FIRST END [--varied] [--given SD] [--program P] [--studies DIR] [--jobs N] [-- ARGUMENT...]
       run.py --table ROWS...
KINDS: comma-separated, of image, fbp, osem, corrected. Seeds FIRST to END - 1. One row of JSON per reading on standard
output, the table of all rows on standard error. --varied: walls of 0.7 to 1.4 times the usual volume, collimators of
high resolution and of general purpose, orbits of other radii and along the body. --given: the wall's true thickness is
given to the fit, off by an error of this standard deviation (of its log), which is told. DIR keeps the studies for the
next call. Arguments after -- go to `dynasurf ventricle`.
"""

import argparse
import concurrent.futures
import contextlib
import json
import math
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile

PROGRAM = pathlib.Path(__file__).resolve().parents[2] / "build/release/bin/dynasurf"
KINDS = {
    "image": {},
    "fbp": {"reconstruction.method": "fbp"},
    "osem": {"reconstruction.method": "osem"},
    "corrected": {"reconstruction.method": "osem", "reconstruction.iterations": 5, "reconstruction.attenuation": "true",
                  "reconstruction.scatter": "true", "reconstruction.resolution": "true",
                  "reconstruction.filter_fwhm_mm": 8},
}
QUANTITIES = {"edv": "edv_ml", "esv": "esv_ml", "ef": "ef_percent", "wall": "wall_ml"}


def heart_of(seed):
    dice = random.Random(104729 * seed)
    edv = round(dice.uniform(70, 230))
    heart = {"edv_ml": edv, "ef_percent": round(dice.uniform(28, 68)), "wall_ml": round(75 + 0.35 * edv + dice.uniform(-20, 20)),
             "length_to_width": round(dice.uniform(1.4, 1.9), 2), "irregular.walls": round(dice.uniform(0.3, 1), 2),
             "irregular.papillary_mm": round(dice.uniform(2, 4), 1),
             "right_ventricle": round(dice.uniform(0.3, 0.5), 2)}
    if dice.random() < 0.3:
        heart |= {"defect": dice.choice(["septal", "inferior", "lateral"]), "defect_severity": round(dice.uniform(0.4, 0.8), 2),
                  "defect_extent_deg": round(dice.uniform(40, 90))}
    body = {"torso.liver": round(dice.uniform(0.4, 1), 2), "azimuth_deg": round(dice.uniform(35, 55)),
            "elevation_deg": round(dice.uniform(15, 35))}
    camera = {"acquisition.million_counts": round(dice.uniform(2.5, 6), 1), "reorientation.axis_error_deg": round(dice.uniform(0, 4), 1), "reorientation.axis_error_towards_deg": round(dice.uniform(-180, 180))}
    return heart, body, camera, round(dice.uniform(0.32, 0.45), 2), round(dice.uniform(10, 15), 1)


def vary(seed, heart, camera):
    dice = random.Random(7919 * seed)
    heart["wall_ml"] = round(heart["wall_ml"] * 0.7 * 2 ** dice.uniform(0, 1))
    camera["acquisition.collimator"] = dice.choice(["lehr", "legp"])
    if dice.random() < 0.3:
        camera["acquisition.orbit"] = "body_contour"
    else:
        camera["acquisition.radius_mm"] = round(dice.uniform(190, 250))


def make(program, kind, seed, folder, varied):
    if (folder / "truth.json").exists():
        return
    heart, body, camera, cutoff, fwhm = heart_of(seed)
    if varied:
        vary(seed, heart, camera)
    if kind == "image":
        options = heart | {"fwhm_mm": fwhm, "noise.peak_counts": 100, "lattice.nx": 40, "lattice.ny": 40, "lattice.nz": 24,
                           "lattice.dx_mm": 5, "lattice.dy_mm": 5, "lattice.dz_mm": 5}
        what = "patient"
    else:
        options = {f"heart.{name}": value for name, value in (heart | body).items()} | camera | KINDS[kind]
        if kind == "fbp":
            options["reconstruction.cutoff_per_cm"] = cutoff
        what = "camera"
    settings = [word for name, value in options.items() for word in ("--set", f"{name}={value}")]
    subprocess.run([program, "phantom", what, "--seed", str(seed), "--threads", "1", "--quiet", "--out", folder, *settings], check=True)


def thickness(truth, seed, sd):
    apical = 12  # segments 13 to 17
    mm = statistics.mean(s["thickness_ed_mm"] for s in truth["regions"]["segments"][:apical])
    mm *= math.exp(random.Random(977 * seed).gauss(0, sd))
    return ["--set", f"fit.thickness_mm={mm:.2f}", "--set", f"fit.thickness_uncertainty={sd}"]


def read(program, kind, seed, studies, varied, given_sd, arguments):
    made = studies / (f"varied_{kind}_{seed}" if varied else f"{kind}_{seed}")
    make(program, kind, seed, made, varied)
    truth = json.loads((made / "truth.json").read_text())
    if given_sd:
        arguments = [*thickness(truth, seed, given_sd), *arguments]
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run([program, "ventricle", made / "study.dcm", "--threads", "1", "--quiet", "--out", f"{folder}/r", *arguments],
                             capture_output=True, text=True)
        results = pathlib.Path(folder) / "r" / "results.json"
        result = json.loads(results.read_text()) if results.exists() else {"quality": {"verdict": "refused", "flags": []}}
    row = {"kind": kind, "seed": seed, "verdict": result["quality"]["verdict"],
           "flags": [f["code"] for f in result["quality"]["flags"] if f["severity"] != "info"],
           "truth": {"edv": truth["edv_ml"], "esv": truth["esv_ml"], "ef": truth["ef_percent"], "wall": truth["gates"][0]["wall_ml"]},
           "read": {}, "sd": {}, "reading": result.get("reading")}
    for short, name in QUANTITIES.items():
        row["read"][short] = result.get(name)
        interval = result.get(name + "_90")
        row["sd"][short] = (interval[1] - interval[0]) / 3.29 if interval else None
    fit = (result.get("readings") or {}).get("psf_corrected") or {}
    edge = (result.get("readings") or {}).get("edge") or {}
    row["edge"] = {"edv": edge.get("edv_ml"), "ef": edge.get("ef_percent")}
    row["fit"] = {name: fit.get(name) for name in ("fwhm_mm", "lobes", "objective", "steps", "extracardiac_sources", "thickness_from_data",
                                                     "width_from_data")}
    if run.returncode not in (0, 3):
        row["error"] = run.stderr.strip()
    return row


def table(rows):
    print("| kind | n | found | EDV % | ESV % | EF points | wall % | 90 % hold EDV/ESV/EF/wall | half width EDV % | wrong | wrong `ok` | right flagged | edge EDV %, EF |",
          "|---|---|---|---|---|---|---|---|---|---|---|---|---|", sep="\n")
    for kind in dict.fromkeys(r["kind"] for r in rows):
        of_kind = [r for r in rows if r["kind"] == kind]
        fitted = [r for r in of_kind if r["reading"] == "psf_corrected" and r["read"]["edv"]]

        def error(r, q, of="read"):
            return r[of][q] - r["truth"][q] if q == "ef" else 100 * (r[of][q] / r["truth"][q] - 1)

        def spread(q, of="read"):
            errors = [error(r, q, of) for r in fitted if r[of][q] is not None]
            return f"{statistics.mean(errors):+.1f} ± {statistics.pstdev(errors):.1f}" if errors else "-"

        def held(q):
            return f"{100 * sum(abs(r['read'][q] - r['truth'][q]) <= 1.645 * r['sd'][q] for r in fitted) / max(1, len(fitted)):.0f}"

        wrong = [r for r in of_kind if not r["read"]["edv"] or abs(error(r, "edv")) > 15 or abs(error(r, "ef")) > 8]
        half = statistics.mean(164.5 * r["sd"]["edv"] / r["read"]["edv"] for r in fitted) if fitted else 0
        print(f"| {kind} | {len(of_kind)} | {len(fitted)} | " + " | ".join(spread(q) for q in QUANTITIES) + " | " +
              "/".join(held(q) for q in QUANTITIES) + f" | {half:.1f} | {len(wrong)} | {sum(r['verdict'] == 'ok' for r in wrong)} | "
              f"{sum(r['verdict'] != 'ok' for r in of_kind if r not in wrong)} | {spread('edv', 'edge')}, {spread('ef', 'edge')} |")


def main():
    words = sys.argv[1:]
    if words[:1] == ["--table"]:
        table([json.loads(line) for name in words[1:] for line in open(name)])
        return
    arguments = words[words.index("--") + 1:] if "--" in words else []
    parser = argparse.ArgumentParser()
    parser.add_argument("kinds")
    parser.add_argument("first", type=int)
    parser.add_argument("end", type=int)
    parser.add_argument("--varied", action="store_true")
    parser.add_argument("--given", type=float, metavar="SD")
    parser.add_argument("--program", default=PROGRAM)
    parser.add_argument("--studies", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args(words[:words.index("--")] if "--" in words else words)
    with tempfile.TemporaryDirectory() as scratch, concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        studies = given.studies or pathlib.Path(scratch)
        jobs = [pool.submit(read, given.program, kind, seed, studies, given.varied, given.given, arguments)
                for kind in given.kinds.split(",") for seed in range(given.first, given.end)]
        rows = []
        for job in jobs:
            rows.append(job.result())
            print(json.dumps(rows[-1]), flush=True)
    with contextlib.redirect_stdout(sys.stderr):
        table(rows)


if __name__ == "__main__":
    main()
