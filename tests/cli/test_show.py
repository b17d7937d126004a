"""`dynasurf show`: pictures of what a study, a result or a mesh passed through."""

import functools
import json
import os
import re
import shutil
import unittest

from cli import CliTest, run, shared_folder, small_patient
from test_sheets import size_of_png

GATE = ["slice", "field", "field3d", "voxels", "labels", "damping", "evolution", "scatter", "histogram"]
SURFACE = ["mesh", "section", "areas", "smooth"]
BEAT = ["cycle", "curve"]


@functools.cache
def staged_result():
    folder = shared_folder() / "staged"
    made = run("ventricle", small_patient() / "study.dcm", "--out", folder, "--preset", "edges", "--keep-stages", "--quiet")
    assert made.returncode in (0, 3), made.stderr
    return folder


@functools.cache
def from_study(what):
    out = shared_folder() / f"study_{what}.png"
    made = run("show", small_patient() / "study.dcm", what, "--out", out, "--quiet", "--preset", "edges", "--gate", 2)
    assert made.returncode == 0, f"{what}: {made.stderr}"
    return out


class Show(CliTest):
    def draw(self, source, what, *arguments, ending="png"):
        out = self.folder / f"{what}.{ending}"
        made = run("show", source, what, "--out", out, "--quiet", *arguments)
        self.assertEqual(made.returncode, 0, f"{what}: {made.stderr}")
        return out

    def test_every_picture_comes_from_a_study(self):
        for what in [*GATE, *SURFACE, *BEAT, "contour"]:
            width, height = size_of_png(from_study(what))
            self.assertGreater(width, 700, what)
            self.assertGreater(height, 300, what)

    def test_and_the_same_from_its_result(self):
        for what in [*GATE, *SURFACE, *BEAT]:
            drawn = self.draw(staged_result(), what, "--gate", 2)
            if what not in ("evolution", "scatter", "smooth"):  # meshes that went through the world and back are rounded
                self.assertEqual(drawn.read_bytes() == from_study(what).read_bytes(), True, what)

    def test_films_are_animated_pictures(self):
        for what, least in (("evolution-film", 25), ("beat-film", 40)):
            data = self.draw(staged_result(), what, "--gate", 2).read_bytes()
            self.assertEqual(data.count(b"acTL"), 1, what)
            self.assertGreaterEqual(data.count(b"fcTL"), least, what)
            self.refuses(1, "show", staged_result(), what, "--out", self.folder / "no.svg", says=[".png"])

    def test_a_cloud_is_shown_200_times(self):
        folder = self.folder / "cloud"
        run("phantom", "cloud", "--out", self.folder / "scan", "--set", "points=4000", "--quiet")
        made = run("cloud", self.folder / "scan" / "cloud.ply", "--out", folder, "--triangles", "1280,320", "--quiet")
        self.assertIn(made.returncode, (0, 3), made.stderr)
        text = self.draw(folder, "instances", ending="svg").read_text()
        self.assertGreater(text.count("<path"), 200 * 100)  # half of 320 triangles at least, 200 times
        self.refuses(2, "show", staged_result(), "instances", "--out", self.folder / "no.png", says=["dynasurf.cloud/1"])

    def test_a_result_without_stages_says_what_it_lacks(self):
        folder = shared_folder() / "bare"
        if not folder.exists():
            run("ventricle", small_patient() / "study.dcm", "--out", folder, "--preset", "edges", "--quiet")
        self.draw(folder, "mesh")
        self.draw(folder, "curve")
        self.refuses(2, "show", folder, "slice", "--out", self.folder / "no.png", says=["--keep-stages"])
        self.refuses(2, "show", folder, "contour", "--out", self.folder / "no.png", says=["study"])

    def test_a_mesh_by_itself(self):
        mesh = staged_result() / "meshes" / "epi_g01.ply"
        for what in ("mesh", "areas", "smooth"):
            self.draw(mesh, what)
        self.refuses(2, "show", mesh, "cycle", "--out", self.folder / "no.png", says=["mesh"])

    def test_svg_holds_lines_and_no_pixels(self):
        text = self.draw(staged_result(), "histogram", ending="svg").read_text()
        self.assertTrue(text.startswith("<?xml"), text[:40])
        self.assertGreater(len(re.findall("<path", text)), 20)
        self.assertNotIn("data:image", text)

    def test_the_same_bytes_for_any_number_of_threads(self):
        one = self.draw(staged_result(), "evolution", "--threads", 1).read_bytes()
        (self.folder / "evolution.png").unlink()
        self.assertEqual(one, self.draw(staged_result(), "evolution", "--threads", 3).read_bytes())

    def test_stages_that_were_tampered_with_are_refused(self):
        folder = self.folder / "result"
        shutil.copytree(staged_result(), folder)
        stages = folder / "stages"

        def refused(what, file, says):
            self.refuses(2, "show", folder, what, "--out", self.folder / "no.png", "--quiet", says=[says])
            shutil.copy(staged_result() / "stages" / file, stages / file)

        history, border = "g01_history_epi.csv", "g01_border_epi.nrrd"
        (stages / history).write_text("step,a,b,c,d\n1,2,three,4,5\n")
        refused("histogram", history, "line 2")
        for row in ("1,2,3,4,5,6", "1,2,3,4,1234567890", "1,2,3,4,5 of them"):
            (stages / history).write_text(f"step,a,b,c,d\n{row}\n")
            refused("histogram", history, "line 2: expected five numbers")
        (stages / history).write_text("step,a,b,c,d\n1,0,0,0,0\n")
        refused("histogram", history, "without particles")
        (stages / history).unlink()
        os.mkfifo(stages / history)
        self.refuses(2, "show", folder, "histogram", "--out", self.folder / "no.png", says=[history])
        (stages / history).unlink()
        whole = (stages / border).read_bytes()
        (stages / border).write_bytes(whole[: len(whole) // 2])
        refused("voxels", border, border)
        head, _, data = whole.partition(b"\n\n")
        (stages / border).write_bytes(head + b"\n\n" + bytes(len(data)))
        refused("voxels", border, "no border voxel")
        (stages / "g01_edge_map_epi.nrrd").write_bytes(whole.replace(b"space origin: (", b"space origin: (7"))
        self.refuses(2, "show", folder, "slice", "--out", self.folder / "no.png", says=["another grid"])
        (stages / "g01_edge_map_epi.nrrd").unlink()
        (stages / "g01_evolved_epi.ply").unlink()
        (stages / "g01_evolved_epi.ply").write_text(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1e300 0 0\n0 1 0\n3 0 1 2\n")
        refused("scatter", "g01_evolved_epi.ply", "far from")
        results = json.loads((folder / "results.json").read_text())
        for value in (1e308, -1e308):
            results["gates"][0]["endo_ml"] = value
            (folder / "results.json").write_text(json.dumps(results))
            self.assertIn(run("show", folder, "curve", "--out", self.folder / f"{value}.png").returncode, (0, 2))

    def test_what_makes_no_sense_is_refused(self):
        result = staged_result()
        for code, says, arguments in ((1, ["slice, field"], ["portrait"]), (1, ["--gate 9"], ["mesh", "--gate", 9]),
                                      (1, ["--wall"], ["mesh", "--wall", "left"]),
                                      (1, ["--slice 999"], ["slice", "--slice", 999]),
                                      (1, ["--row 999"], ["slice", "--row", 999]),
                                      (1, ["--steps 99999"], ["evolution", "--steps", "0,99999"])):
            out = self.folder / "no.png"
            self.refuses(code, "show", result, *arguments, "--out", out, says=says)
            self.assertFalse(out.exists())
        self.refuses(1, "show", result, "mesh", "--out", self.folder / "no.jpeg", says=[".png or .svg"])


if __name__ == "__main__":
    unittest.main()
