#!/usr/bin/env python3
"""Opens a result of `dynasurf ventricle` in ParaView, Blender and MeshLab, compares what they see with results.json, and
writes a page with a picture for ParaView and one for Blender.

    viewer_pages.py RESULT FOLDER [paraview|blender|meshlab ...]

Programs that are not installed are left out (on Debian: paraview, blender, meshlab; without a screen xvfb too). Exit code
77: none is. Where RESULT is '-', DYNASURF_PROGRAM makes that of a virtual patient.
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PAGES = {
    "paraview": """# The beating heart in ParaView

`File > Open` takes `cycle.pvd` of a result; *Apply* shows both walls, and *Play* lets them beat in the times of the gates.
Part 0 is the inner wall, part 1 the outer one: *Extract Block* tells them apart.
*Coloring* offers the values of the vertices: {arrays}.
Coordinates are those of the patient (LPS, mm).

![The wall at end systole in ParaView, coloured by its thickness](paraview.png)

The picture is made by `tools/viewers/in_paraview.py` with `pvbatch`.
""",
    "blender": """# The beating heart in Blender

`File > Import > glTF 2.0` takes `cycle.glb` of a result; the space bar lets it beat.
The gates are shape keys of two meshes, {shapes} each with the base; the actions {actions} move them.
Blender turns the file's metres so that the head is up: x to the patient's left, y to the back, z to the head.
Debian 12's Blender 3.4 needs `import numpy; numpy.bool = bool` in its Python console first.

![The heart at end systole in Blender](blender.png)

The picture is made by `tools/viewers/in_blender.py`.
""",
}


def run(*words):
    """What a program prints; on a screen of its own where it needs one and there is none."""
    words = [str(word) for word in words]
    if words[0] != "blender" and not os.environ.get("DISPLAY"):
        words = ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", *words]
    for last in (False, False, True):  # such a screen is not always there in time
        done = subprocess.run(words, capture_output=True, text=True, timeout=500)
        if done.returncode == 0:
            return done.stdout
        if last or "XOpenGLRenderWindow" not in done.stdout + done.stderr:
            sys.exit(f"{words}: exit code {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")


def near(seen, expected, what, relative=1e-5):
    assert abs(seen - expected) <= relative * abs(expected), f"{what}: {seen} instead of {expected}"


def bounds_of(ply):
    """The box around a PLY of the program, whose vertices begin with three doubles."""
    import numpy as np

    content = ply.read_bytes()
    head, _, body = content.partition(b"end_header\n")
    count = int(re.search(rb"element vertex (\d+)", head)[1])
    floats = len(re.findall(rb"property float", head.split(b"element face")[0]))
    rows = np.frombuffer(body, [("at", "<f8", 3), ("more", "<f4", floats)], count)["at"]
    return np.column_stack([rows.min(axis=0), rows.max(axis=0)]).ravel()


def in_paraview(result, results, picture):
    seen = json.loads(run("pvbatch", HERE / "in_paraview.py", result, picture).splitlines()[-1])
    times = [gate["time_ms"] for gate in results["gates"]]
    assert len(seen["times"]) == len(times)
    for gate, (time, walls) in enumerate(zip(seen["times"], seen["walls"], strict=True)):
        assert abs(time - times[gate]) < 1e-6, f"gate {gate + 1} at {time}"
        for wall, (_, box) in zip(("endo", "epi"), walls, strict=True):
            expected = bounds_of(result / f"meshes/{wall}_g{gate + 1:02d}.ply")
            assert max(abs(a - b) for a, b in zip(box, expected, strict=True)) < 1e-9, f"{wall} of gate {gate + 1}"
    return {"arrays": ", ".join(f"`{name}`" for name in seen["arrays"] if name != "Normals")}


def in_blender(result, results, picture):
    words = ("-b", "-noaudio", "--python-exit-code", "1", "-P", HERE / "in_blender.py", "--", result, picture)
    text = run("blender", *words)
    seen = json.loads(re.search(r"^seen (.*)$", text, re.M)[1])
    gates = results["gates"]
    assert seen["shapes"] == {"endo": len(gates), "epi": len(gates)}, seen["shapes"]
    for gate, volumes in zip(gates, seen["volumes_ml"], strict=True):
        for wall, volume in zip(("endo", "epi"), volumes, strict=True):
            near(volume, gate[f"{wall}_ml"], f"{wall} of gate {gate['gate']} in mL", 1e-4)  # single precision
    return {"shapes": len(gates), "actions": " and ".join(f"`{name}`" for name in seen["actions"])}


def in_meshlab(result, results, picture):
    for wall in ("endo", "epi"):
        text = run("meshlabserver", "-i", result / f"meshes/{wall}_g01.ply", "-s", HERE / "measures.mlx")
        near(float(re.search(r"Mesh Volume +is ([\d.]+)", text)[1]) / 1000, results["gates"][0][f"{wall}_ml"], wall)
        assert "Mesh is two-manifold" in text and "Genus is 0" in text and "Mesh has 0 holes" in text, text
    return {}


PROGRAMS = {"paraview": ("pvbatch", in_paraview), "blender": ("blender", in_blender), "meshlab": ("meshlabserver", in_meshlab)}


def made_result(folder):
    program = os.environ["DYNASURF_PROGRAM"]
    patient = [program, "phantom", "patient", "--out", folder / "patient", "--set", "gates=8", "--quiet"]
    subprocess.run(patient, check=True)
    subprocess.run([program, "ventricle", folder / "patient/study.dcm", "--out", folder / "result", "--quiet"], check=True)
    return folder / "result"


def main():
    folder = pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    asked = sys.argv[3:] or list(PROGRAMS)
    there = [name for name in asked if shutil.which(PROGRAMS[name][0])]
    if not os.environ.get("DISPLAY") and not shutil.which("xvfb-run"):
        there = [name for name in there if name == "blender"]
    if not there:
        print(f"skipped: {', '.join(asked)} not installed, or there is no screen for it (apt-get install xvfb)")
        return 77
    with tempfile.TemporaryDirectory() as scratch:
        result = made_result(pathlib.Path(scratch)) if sys.argv[1] == "-" else pathlib.Path(sys.argv[1]).resolve()
        results = json.loads((result / "results.json").read_text())
        for name in there:
            words = PROGRAMS[name][1](result, results, (folder / f"{name}.png").resolve())
            if name in PAGES:
                (folder / f"in-{name}.md").write_text(PAGES[name].format(**words))
            print(f"{name}: opens {len(results['gates'])} gates as they are")
    return 0


if __name__ == "__main__":
    sys.exit(main())
