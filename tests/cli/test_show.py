"""`dynasurf show`: pictures of what a study, a result or a mesh passed through."""

import functools
import re
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
            if what != "evolution":  # whose start went through the world and back, and is rounded
                self.assertEqual(drawn.read_bytes() == from_study(what).read_bytes(), True, what)

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
