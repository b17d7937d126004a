#!/usr/bin/env python3
"""Hearts with defects behind the camera whose file does not tell apex from base: which lie on their heads?

usage: ends.py FIRST END [--low] [--program P] [--studies DIR] [--jobs N]
Seeds FIRST to END - 1. --low: bases that move by 1 to 5 mm instead of 12. A line per study: the cosine between the axis
that was found and the true one, the verdict, EDV and EF with their truth, the notes on the ends. DIR keeps the studies.
"""

import argparse
import concurrent.futures
import json
import pathlib
import random
import subprocess
import tempfile

PROGRAM = pathlib.Path(__file__).resolve().parents[2] / "build/release/bin/dynasurf"
ORDER = b"\x54\x00\x00\x05CS"  # SliceProgressionDirection
TRUE_AXIS = (-0.612, 0.612, 0.5)  # azimuth 45, elevation 30 degrees


def settings_of(seed, is_low):
    """None for the seeds that drew a defect which the phantom does not have."""
    dice = random.Random(seed)
    heart = {"edv_ml": dice.choice([60, 90, 120, 160, 220]), "ef_percent": dice.choice([25, 35, 45, 60, 70])}
    others = ["none", "lateral" if is_low else None, "inferior", "anteroapical"]
    heart["defect"] = "apical" if dice.random() < 0.75 else dice.choice(others)
    if is_low:
        heart["base_excursion_mm"] = dice.choice([1, 3, 5])
    heart["defect_severity"] = round(dice.uniform(0.5, 1), 2)
    heart["defect_extent_deg"] = dice.choice([40, 60, 80, 110])
    heart["right_ventricle"] = dice.choice([0, 0.4])
    camera = {"acquisition.oversampling": 1, "acquisition.million_counts": 4, "reconstruction": dice.choice(["fbp", "osem"])}
    if dice.random() < 0.3:
        heart["defect_extent_deg"] = 80
    return {f"heart.{k}": v for k, v in heart.items()} | camera if heart["defect"] else None


def read(seed, a, folder):
    settings = settings_of(seed, a.low)
    if settings is None:
        return f"{seed} no such defect"
    made, study, result = folder / f"{seed}", folder / f"{seed}.dcm", folder / f"r{seed}"
    if not made.exists():
        sets = [word for path, value in settings.items() for word in ("--set", f"{path}={value}")]
        subprocess.run([a.program, "phantom", "camera", "--seed", str(seed), "--quiet", "--threads", "1", "--out", made, *sets],
                       check=True)
    data = (made / "study.dcm").read_bytes()
    at = data.index(ORDER) + 8
    length = int.from_bytes(data[at - 2:at], "little")
    study.write_bytes(data[:at] + b" " * length + data[at + length:])
    subprocess.run([a.program, "ventricle", study, "--quiet", "--threads", "1", "--out", result],
                   stdout=subprocess.DEVNULL)
    truth, found = (json.loads((where / name).read_text()) for where, name in ((made, "truth.json"), (result, "results.json")))
    axis = (found["heart"] or {}).get("axis", (0, 0, 0))
    codes = [flag["code"] for flag in found["quality"]["flags"] if "ends" in flag["code"]]
    return (f"{seed} cos {sum(x * y for x, y in zip(axis, TRUE_AXIS)):.2f} {found['quality']['verdict']} "
            f"EDV {found['edv_ml']} of {truth['edv_ml']:.0f} EF {found['ef_percent']} of {truth['ef_percent']:.0f} {codes}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first", type=int)
    parser.add_argument("end", type=int)
    parser.add_argument("--low", action="store_true")
    parser.add_argument("--program", default=PROGRAM)
    parser.add_argument("--studies", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=2)
    a = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch, concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        folder = a.studies or pathlib.Path(scratch)
        folder.mkdir(exist_ok=True)
        for line in pool.map(lambda seed: read(seed, a, folder), range(a.first, a.end)):
            print(line, flush=True)


if __name__ == "__main__":
    main()
