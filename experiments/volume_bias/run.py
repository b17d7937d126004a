#!/usr/bin/env python3
"""Reconstructs virtual patients of known volumes at several resolutions and prints what the classic method reads."""
import argparse
import json
import pathlib
import subprocess
import sys

PATIENTS = {
    "normal": {"edv_ml": 110, "ef_percent": 60, "wall_ml": 120},
    "small": {"edv_ml": 50, "ef_percent": 70, "wall_ml": 75},
    "dilated": {"edv_ml": 250, "ef_percent": 24, "wall_ml": 160},
}
RESOLUTIONS_MM = (8, 10, 12, 13, 14, 16)


def run(command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode not in (0, 3):  # 3: computed, not trustworthy; the table shows the verdict
        sys.exit(f"{' '.join(map(str, command))}: {done.stderr.strip()}")


def reconstruct(program, study, out):
    run([program, "ventricle", study, "--out", out, "--preset", "edges", "--quiet", "--mesh-format", "ply"])
    return json.loads((out / "results.json").read_text())


def truth_in_one_form(truth):
    """Truth files of this program and of the atlas cases name the same things differently."""
    if "edv_ml" in truth:
        return truth["edv_ml"], truth["esv_ml"], truth["ef_percent"], [g["wall_ml"] for g in truth["gates"]]
    return truth["EDV_mL"], truth["ESV_mL"], truth["EF_percent"], [g["myo_mL"] for g in truth["gates"]]


def row(name, truth, result):
    edv, esv, ef, walls = truth_in_one_form(truth)
    quality = result["quality"]
    if result["ef_percent"] is None:
        return f"| {name} | {edv:.1f} / {esv:.1f} / {ef:.1f} | - | - | - | - | - | {quality['verdict']} |", None
    measured = [gate["wall_ml"] for gate in result["gates"]]
    cells = [
        name,
        f"{edv:.1f} / {esv:.1f} / {ef:.1f}",
        f"{result['edv_ml']:.1f} / {result['esv_ml']:.1f} / {result['ef_percent']:.1f}",
        f"{100 * (result['edv_ml'] / edv - 1):+.1f} %",
        f"{100 * (result['esv_ml'] / esv - 1):+.1f} %",
        f"{result['ef_percent'] - ef:+.1f}",
        f"{min(measured):.0f}-{max(measured):.0f} ({min(walls):.0f}-{max(walls):.0f})",
        quality["verdict"],
    ]
    return "| " + " | ".join(cells) + " |", abs(result["ef_percent"] - ef)


def gate_rows(title, truth, result):
    """The volumes of every gate beside their truth."""
    key = ("endo_ml", "epi_ml", "wall_ml") if "edv_ml" in truth else ("endo_mL", "epi_mL", "myo_mL")
    lines = [f"## {title}", "", "| gate | endo (true) mL | epi (true) mL | wall (true) mL |", "|---|---|---|---|"]
    for gate, true in zip(result["gates"], truth["gates"]):
        pairs = zip((gate["endo_ml"], gate["epi_ml"], gate["wall_ml"]), (true[k] for k in key))
        cells = [f"{a:.1f} ({b:.1f})" if a is not None else f"- ({b:.1f})" for a, b in pairs]
        lines.append(f"| {gate['gate']} | " + " | ".join(cells) + " |")
    return lines + [""]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default="build/release/bin/dynasurf", type=pathlib.Path)
    parser.add_argument("--out", default="build/volume_bias", type=pathlib.Path)
    parser.add_argument("--atlas", type=pathlib.Path, help="folder of cases: */truth.json beside */gspect_noisy.dcm")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)

    head = ["| case | true EDV / ESV mL / EF % | read | EDV | ESV | EF points | wall mL (true) | verdict |", "|" + "---|" * 8]
    table, gates, worst = [], [], 0.0
    for fwhm in RESOLUTIONS_MM:
        for kind, settings in PATIENTS.items():
            case = arguments.out / f"{kind}_{fwhm}mm"
            settings = {**settings, "fwhm_mm": fwhm, "noise.filter_fwhm_mm": min(8, fwhm)}
            run([arguments.program, "phantom", "patient", "--out", case / "study", "--seed", 1, "--quiet"]
                + [part for key, value in settings.items() for part in ("--set", f"{key}={value}")])
            truth = json.loads((case / "study" / "truth.json").read_text())
            result = reconstruct(arguments.program, case / "study" / "study.dcm", case / "result")
            line, error = row(f"{kind}, {fwhm} mm", truth, result)
            table.append(line)
            if fwhm <= 13 and error is not None:
                worst = max(worst, error)
            if kind == "normal":
                gates += gate_rows(f"{kind}, {fwhm} mm", truth, result)
    if arguments.atlas:
        for truth_file in sorted(arguments.atlas.glob("*/truth.json")):
            truth = json.loads(truth_file.read_text())
            name = truth_file.parent.name
            result = reconstruct(arguments.program, truth_file.parent / "gspect_noisy.dcm", arguments.out / name)
            line, error = row(f"atlas {name}, {truth['fwhm_mm']:.0f} mm", truth, result)
            table.append(line)
            if not truth["defect"]:
                worst = max(worst, error or 0)
            gates += gate_rows(f"atlas {name}", truth, result)
    text = "\n".join(head + table + ["", f"Largest error of the ejection fraction at 13 mm or less, without a defect: {worst:.1f} points.", ""]
                     + gates)
    (arguments.out / "results.txt").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
