#!/usr/bin/env python3
"""Every command of the program, once, on small inputs: for a program built with sanitizers, or one watched by Valgrind.

    whole_jobs.py --program build/asan/bin/dynasurf
    whole_jobs.py --program build/release/bin/dynasurf --wrapper "valgrind -q --leak-check=full --error-exitcode=99"

A job fails when it ends with another code than 0 (or 3, where the smallest inputs cannot be trusted) or says anything of
a sanitizer or of Valgrind. All jobs are run; the exit code tells whether one failed."""

import argparse
import gzip
import math
import os
import pathlib
import shlex
import struct
import subprocess
import sys
import tempfile
import time

TINY = ["gates=4", "lattice.nx=24", "lattice.ny=24", "lattice.dx_mm=7", "lattice.dy_mm=7", "lattice.dz_mm=7", "fwhm_mm=12",
        "noise.peak_counts=400"]
PHANTOMS = ("hebron", "mayo", "partial", "spheres", "sphere", "gap", "cycle", "pathology")
COMPLAINTS = ("Sanitizer", "runtime error:", "== Invalid", "== Conditional jump", "== Use of uninitialised",
              "== Syscall param", "lost in loss record", "still reachable in loss")
# They start /proc/self/exe again, which is Valgrind's own program where Valgrind watches: there they run without it.
START_THEMSELVES = ("batch", "bids")
SANITIZERS = {
    "LSAN_OPTIONS": f"suppressions={pathlib.Path(__file__).with_name('leaks.supp').resolve()}:print_suppressions=0",
    "ASAN_OPTIONS": "exitcode=99:detect_leaks=1:detect_stack_use_after_return=1:strict_string_checks=1",
    "UBSAN_OPTIONS": "print_stacktrace=1:exitcode=99",
    "TSAN_OPTIONS": "exitcode=99:second_deadlock_stack=1",
}


def sets(*settings):
    return [word for setting in settings for word in ("--set", setting)]


def patient_jobs():
    """Virtual patients, and all that is done with a gated study."""
    yield "phantom patient", ["phantom", "patient", "--seed", "7", "--nrrd", "--out", "patient", *sets(*TINY)]
    yield "phantom patient with tags", ["phantom", "patient", "--seed", "7", "--out", "tagged", *sets(
        *TINY, "tags.points=40", "tags.twist_deg=15")]
    study = "patient/study.dcm"
    yield "info", ["info", study]
    yield "info --json", ["info", "patient/study.nii.gz", "--json"]
    yield "info of NRRD", ["info", "patient/study.seq.nrrd"]
    yield "edges", ["borders", study, "--edges-only", "--out", "edges", "--vary",
                    "edges=canny,canny_revised,gradient,sobel,compass,acc"]
    yield "borders", ["borders", study, "--out", "borders", "--vary", "labels.method=none,sign,gradmag,case,radial,mlc"]
    yield "ventricle with all files", ["ventricle", study, "--out", "fit", "--keep-stages", "--dicom", "--with-phi",
                                       "--mesh-format", "ply,stl,obj,off,vtp,glb"]
    yield "rerun", ["rerun", "fit", "--study", study, "--out", "again"]
    yield "rerun again", ["rerun", "fit", "--study", study, "--out", "third"]
    yield "normals", ["perfusion", "build", ".", "--out", "normals.json"]
    yield "ventricle of edges", ["ventricle", "patient/study.nii.gz", "--out", "classic", "--preset", "edges",
                                 "--mask", "mask.nii", "--start", "fit/meshes/epi_g01.ply"]
    yield "ventricle by hand", ["ventricle", study, "--out", "hand", "--mask", "mask.nii",
                                *sets("manual.base_shift_mm=-4", "manual.exclude_gates=2")]
    yield "view", ["view", study, "--page", "page.html", "--out", "view.html"]
    yield "ventricle of contours", ["ventricle", "patient/study.seq.nrrd", "--out", "contour", "--pipeline", "contour"]
    yield "ventricle by the thesis", ["ventricle", study, "--out", "thesis", "--preset", "thesis", "--threads", "1"]
    yield "scores", ["perfusion", "score", "fit", "--edit", "edit.json", "--out", "scores.json"]
    yield "compare", ["perfusion", "compare", "fit", "again", "--out", "compared"]
    yield "solid", ["solid", "fit", "--gate", "1", "--out", "wall.vtu"]
    yield "solid for Gmsh", ["solid", "classic", "--gate", "1", "--out", "wall.msh"]
    yield "solid for Abaqus", ["solid", "classic", "--gate", "1", "--out", "wall.inp"]
    yield "motion", ["motion", "tagged/points.csv", "--result", "fit", "--out", "motion"]
    for ending in ("ply", "stl", "obj", "off"):
        yield f"measure {ending}", ["measure", f"fit/meshes/endo_g01.{ending}", "--json"]


def cloud_jobs():
    yield "phantom cloud", ["phantom", "cloud", "--seed", "3", "--out", "scan", *sets("shape=torus", "points=1500")]
    yield "cloud", ["cloud", "scan/cloud.ply", "--out", "levels", "--triangles", "320,160,80", "--textures",
                    "--mesh-format", "ply,stl,obj,off,vtp,glb"]
    yield "cloud of rows", ["cloud", "points.xyz", "--out", "hull", "--triangles", "160", "--start", "hull"]
    yield "cloud by the thesis", ["cloud", "scan/cloud.ply", "--out", "cloud-thesis", "--preset", "thesis", "--triangles",
                                  "320"]
    yield "lod", ["lod", "levels", "--out", "lod", "--steps", "1"]
    yield "rerun of a cloud", ["rerun", "levels", "--study", "scan/cloud.ply"]


def cohort_jobs():
    """Sanitizers take address space without bounds: the limit of a study is above it."""
    yield "phantom patients", ["phantom", "patients", "--count", "2", "--seed", "5", "--small", "--out", "patients", *sets(
        "gates=2", "lattice.nx=28", "lattice.ny=28", "lattice.nz=16")]
    yield "batch", ["batch", "patients/patients.tsv", "--out", "cohort", "--memory-limit", "100T", "--time-limit", "0", "--",
                    "--preset", "edges", *sets("mesh_level=1")]
    yield "collect", ["collect", "cohort", "--out", "tables", "--compare", "cohort"]
    yield "bids", ["bids", "dataset", "derivatives", "participant", "--memory-limit", "100T", "--", "--preset", "edges"]
    yield "bids of the group", ["bids", "dataset", "derivatives", "group"]


def other_jobs():
    yield "phantom camera", ["phantom", "camera", "--out", "camera", *sets("heart.gates=2", "acquisition.views=16")]
    yield "show of a study", ["show", "patient/study.dcm", "slice", "--out", "study.png"]
    yield "show of a result", ["show", "classic", "cycle", "--out", "result.svg"]
    for kind in PHANTOMS:
        yield f"phantom {kind}", ["phantom", kind, "--out", f"phantom-{kind}"]
    yield "phantom organ", ["phantom", "organ", "--out", "organ-scan", *sets(
        "values=labels", "shape=prostate", "lattice.dx_mm=2.8", "lattice.dy_mm=2.8", "lattice.nx=40", "lattice.ny=40",
        "lattice.dz_mm=4", "lattice.nz=20")]
    yield "organ", ["organ", "organ-scan/study.nii.gz", "--out", "organ", "--label", "1"]
    yield "options", ["options", "--json"]
    yield "options of a phantom", ["options", "phantom", "patient"]
    yield "help", ["ventricle", "--help"]


def write_inputs(folder):
    """What a user brings along; called when the study is there."""
    (folder / "page.html").write_text('<script id="given"></script>')
    (folder / "edit.json").write_text('{"17": 4}')
    turn = [(0.61 * n) % 6.2831853 for n in range(400)]
    rows = []
    for n, angle in enumerate(turn):
        z = 1 - 2 * (n + 0.5) / len(turn)
        r = math.sqrt(1 - z * z)
        rows.append(f"{r * math.cos(angle):.6f} {r * math.sin(angle):.6f} {1.5 * z:.6f} 200 30 {n % 256}")
    (folder / "points.xyz").write_text("\n".join(rows) + "\n")
    packed = folder / "patient" / "study.nii.gz"
    if packed.exists():
        images = folder / "dataset" / "sub-01" / "nm"
        images.mkdir(parents=True, exist_ok=True)
        (images / "sub-01_nm.nii.gz").write_bytes(packed.read_bytes())
        volume = bytearray(gzip.decompress(packed.read_bytes()))
        nx, ny, nz = struct.unpack_from("<3h", volume, 42)
        struct.pack_into("<2h", volume, 40, 3, nx)
        struct.pack_into("<h", volume, 48, 1)
        (folder / "mask.nii").write_bytes(bytes(volume[:352]) + struct.pack(f"<{nx * ny * nz}f", *[1.0] * nx * ny * nz))


class Jobs:
    def __init__(self, program, wrapper, folder, limit):
        self.wrapper, self.program = wrapper, program
        self.folder, self.limit = folder, limit
        self.environment = dict(os.environ)
        for name, value in SANITIZERS.items():
            self.environment[name] = ":".join(filter(None, [value, os.environ.get(name)]))
        self.failed, self.count = [], 0

    def run(self, name, arguments):
        begin = time.monotonic()
        self.count += 1
        wrapper = [] if arguments[0] in START_THEMSELVES else self.wrapper
        try:
            done = subprocess.run([*wrapper, self.program, *arguments], cwd=self.folder, env=self.environment,
                                  stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
                                  timeout=self.limit)
            said, code = done.stderr, done.returncode
        except subprocess.TimeoutExpired:
            said, code = f"was stopped after {self.limit} s\n", None
        failed = code not in (0, 3) or any(word in said for word in COMPLAINTS)
        print(f"{name:28} {time.monotonic() - begin:7.1f} s  exit {code}{'  FAILED' if failed else ''}", flush=True)
        if failed:
            self.failed.append(name)
            complaints = [line for line in said.splitlines() if any(word in line for word in COMPLAINTS)]
            print("\n".join(["   " + shlex.join(arguments), *dict.fromkeys(complaints), said[-4000:]]), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--wrapper", default="", help="a command line put before the program")
    parser.add_argument("--only", default="", help="run the jobs whose name holds this word, and what they need")
    parser.add_argument("--limit", type=float, default=1800, help="seconds for one job")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="dynasurf-jobs-") as folder:
        jobs = Jobs(str(arguments.program.resolve()), shlex.split(arguments.wrapper), pathlib.Path(folder), arguments.limit)
        for name, words in [*patient_jobs(), *cloud_jobs(), *cohort_jobs(), *other_jobs()]:
            if arguments.only not in name and not name.startswith("phantom"):
                continue
            jobs.run(name, words)
            if words[0] == "phantom":
                write_inputs(pathlib.Path(folder))
        print(f"{jobs.count} jobs, {len(jobs.failed)} failed{': ' if jobs.failed else ''}{', '.join(jobs.failed)}")
        return 1 if jobs.failed else 0


if __name__ == "__main__":
    sys.exit(main())
