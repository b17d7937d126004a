#!/usr/bin/env python3
"""Hearts beside gut, liver, gallbladder and bowel many times as hot as the wall: found, right, flagged?

usage: run.py FIRST END [PROGRAM]    seeds FIRST to END - 1; results.txt is the output
"""

import json
import pathlib
import random
import subprocess
import sys
import tempfile

PROGRAM = pathlib.Path(__file__).resolve().parents[2] / "build/release/bin/dynasurf"


def options_of(seed):
    """Odd seeds: a gut at the heart in a small field of view. Even seeds: the organs of a whole trunk, transaxial."""
    dice = random.Random(7919 * seed)
    edv = dice.choice([60, 80, 100, 120, 150, 190])
    options = {"edv_ml": edv, "ef_percent": dice.choice([30, 45, 60, 70]), "wall_ml": int(95 + 0.28 * edv),
               "irregular.walls": 1, "noise.peak_counts": 3 * dice.choice([60, 100, 150]),
               "heart_rate_bpm": dice.choice([60, 75])}
    if seed % 2:
        n, mm = [40, 40, 24], 5
        options |= {"gut_amplitude": dice.choice([2.0, 3.0, 3.8, 5.0]), "gut_gap_mm": dice.choice([2, 5, 8, 12]),
                    "gut_radius_mm": dice.choice([10, 14, 18]), "gut_position": dice.choice([-0.3, 0.0, 0.3, 0.6]),
                    "right_ventricle": dice.choice([0, 0.3])}
    else:
        n, mm = [64, 64, 46], 6.4
        options |= {"torso.present": "true", "torso.liver": dice.choice([0.8, 1.2, 1.6]),
                    "torso.gallbladder": dice.choice([3, 5]), "torso.bowel": dice.choice([0.4, 2.0, 3.5]),
                    "torso.spleen": dice.choice([0.5, 1.2]), "cut": "transaxial"}
    for axis, count in zip("xyz", n):
        options |= {f"lattice.n{axis}": count, f"lattice.d{axis}_mm": mm}
    return options


def read(program, seed, folder):
    """Truth and reading of one study; without numbers where none was made."""
    made = folder / "phantom"
    settings = [word for name, value in options_of(seed).items() for word in ("--set", f"{name}={value}")]
    subprocess.run([program, "phantom", "patient", "--seed", str(seed), "--quiet", "--out", made, *settings], check=True)
    subprocess.run([program, "ventricle", made / "study.dcm", "--quiet", "--out", folder / "result"], check=False)
    truth, results = json.loads((made / "truth.json").read_text()), folder / "result" / "results.json"
    refused = {"edv_ml": None, "ef_percent": None, "quality": {"verdict": "refused", "flags": []}}
    return truth, json.loads(results.read_text()) if results.exists() else refused


def main():
    first, end = int(sys.argv[1]), int(sys.argv[2])
    program = sys.argv[3] if len(sys.argv) > 3 else PROGRAM
    count = {"right": 0, "wrong": 0, "wrong, verdict ok": 0, "right, flagged": 0}
    for seed in range(first, end):
        with tempfile.TemporaryDirectory() as folder:
            truth, result = read(program, seed, pathlib.Path(folder))
        edv, ef = result["edv_ml"], result["ef_percent"]
        wrong = edv is None or abs(edv / truth["edv_ml"] - 1) > 0.15 or abs(ef - truth["ef_percent"]) > 8
        verdict = result["quality"]["verdict"]
        count["wrong" if wrong else "right"] += 1
        count["wrong, verdict ok"] += wrong and verdict == "ok"
        count["right, flagged"] += not wrong and verdict != "ok"
        flags = " ".join(f["code"] for f in result["quality"]["flags"] if f["severity"] != "info")
        hot = " ".join(f"{k}={v}" for k, v in options_of(seed).items() if k.startswith(("gut", "torso")))
        numbers = "" if edv is None else (f"EDV {truth['edv_ml']:.1f} {edv:.1f} ({100 * (edv / truth['edv_ml'] - 1):+.1f} %) "
                                          f"EF {truth['ef_percent']:.0f} {ef:.1f} ")
        print(f"{seed} {'WRONG' if wrong else 'right'} {verdict} {numbers}| {hot} | {flags}", flush=True)
    print(", ".join(f"{name}: {number}" for name, number in count.items()))


if __name__ == "__main__":
    main()
