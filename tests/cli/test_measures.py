"""Normal limits, scores and solids made from results."""

import base64
import functools
import json
import re
import shutil
import unittest

from cli import CliTest, SMALL_PATIENT, run, shared_folder, small_patient, small_result


@functools.cache
def result_of(name, *settings):
    """A reconstructed virtual patient."""
    study, result = shared_folder() / f"{name}-study", shared_folder() / "normals" / name
    if name == "sick":
        result = shared_folder() / "sick"
    result.parent.mkdir(exist_ok=True)
    made = run("phantom", "patient", "--out", study, *SMALL_PATIENT, "--set", "noise.peak_counts=400", *settings)
    assert made.returncode == 0, made.stderr
    made = run("ventricle", study / "study.dcm", "--out", result)
    assert made.returncode in (0, 3), made.stderr
    return result


@functools.cache
def normals():
    for n, volume in enumerate((95, 110, 125)):
        result_of(f"normal{n}", "--seed", str(n + 1), "--set", f"edv_ml={volume}")
    path = shared_folder() / "normals.json"
    made = run("perfusion", "build", shared_folder() / "normals", "--out", path)
    assert made.returncode == 0, made.stderr
    return path


class Normals(CliTest):
    def test_a_defect_is_found_against_normals(self):
        self.assertEqual(json.loads(normals().read_text())["studies"], 3)
        sick = result_of("sick", "--seed", "9", "--set", "defect=inferior", "--set", "defect_extent_deg=70")
        made = run("perfusion", "score", sick, "--normals", normals(), "--json")
        self.assertEqual(made.returncode, 0, made.stderr)
        scores = json.loads(made.stdout)
        of = {s["number"]: s["score"] for s in scores["segments"]}
        self.assertGreaterEqual(of[4] + of[10], 2)
        self.assertEqual(of[1] + of[7], 0)
        self.assertGreater(scores["extent_percent"], 4)
        healthy = json.loads(run("perfusion", "score", shared_folder() / "normals" / "normal1", "--normals", normals(),
                                 "--json").stdout)
        self.assertLess(healthy["extent_percent"], 2)
        self.assertLess(healthy["summed_score"], scores["summed_score"])

    def test_a_person_may_change_scores(self):
        edit = shared_folder() / "edit.json"
        edit.write_text('{"17": 4}')
        out = shared_folder() / "scores.json"
        made = run("perfusion", "score", small_result(), "--edit", edit, "--out", out)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertIn("4 by hand", made.stdout)
        self.assertTrue(json.loads(out.read_text())["segments"][16]["by_hand"])

    def test_says_what_is_wrong_in_one_line(self):
        for text in ("{", "[1]", '{"99": 1}', '{"1": 7}', '{"one": 1}', '{"1": 1.5}'):
            edit = shared_folder() / "bad.json"
            edit.write_text(text)
            made = run("perfusion", "score", small_result(), "--edit", edit)
            self.assertEqual(made.returncode, 2, text)
            self.assertEqual(len(made.stderr.strip().splitlines()), 1, made.stderr)
        empty = shared_folder() / "empty"
        empty.mkdir(exist_ok=True)
        made = run("perfusion", "build", empty, "--out", shared_folder() / "none.json")
        self.assertEqual(made.returncode, 2)
        self.assertIn("at least 3", made.stderr)
        self.assertEqual(run("perfusion", "score", small_result(), "--normals", edit).returncode, 2)


    def test_does_not_mix_what_perfusion_is_made_of(self):
        normals()  # three results by uptake
        mixed = shared_folder() / "mixed"
        if not mixed.exists():
            shutil.copytree(shared_folder() / "normals", mixed)
        path = mixed / "normal1" / "results.json"
        results = json.loads(path.read_text())
        self.assertEqual(results["measures"]["perfusion_is"], "uptake")
        results["measures"]["perfusion_is"] = "counts"
        path.write_text(json.dumps(results))
        self.refuses(2, "perfusion", "build", mixed, "--out", self.folder / "none.json", says="normal1 from counts")
        self.assertFalse((self.folder / "none.json").exists())
        self.refuses(2, "perfusion", "score", mixed / "normal1", "--normals", normals(), says="from counts")
        self.refuses(2, "perfusion", "compare", mixed / "normal0", mixed / "normal1", says="normal0 has perfusion from uptake")
        results["measures"]["perfusion_is"] = "colour"
        path.write_text(json.dumps(results))
        self.refuses(2, "perfusion", "score", mixed / "normal1", says="expected counts or uptake")
        (mixed / "normal1" / "measures" / "polar.csv").unlink()
        self.refuses(2, "perfusion", "compare", mixed / "normal0", mixed / "normal1", says="normal1: has no polar map")


@functools.cache
def blood_pool():
    study, result = shared_folder() / "pool-study", shared_folder() / "pool"
    made = run("phantom", "patient", "--out", study, *SMALL_PATIENT, "--set", "cavity=8", "--set", "background=0.5")
    assert made.returncode == 0, made.stderr
    made = run("ventricle", study / "study.dcm", "--out", result)
    assert made.returncode in (0, 3), made.stderr
    return result


class BloodPool(CliTest):
    def test_tells_of_the_cavity_and_of_no_wall(self):
        results = self.read_json(blood_pool() / "results.json")
        self.assertIn("blood_pool", [flag["code"] for flag in results["quality"]["flags"]])
        measures = results["measures"]
        for key in ("thickness_is", "perfusion_is", "muscle_ml", "muscle_g"):
            self.assertIsNone(measures[key], key)
        self.assertIsNone(measures["phase"]["counts"])
        self.assertEqual(len(measures["segments"]), 17)
        for segment in measures["segments"]:
            self.assertGreater(segment["motion_mm"], 0)
            self.assertIsNone(segment["perfusion_percent"])
            self.assertIsNone(segment["thickness_ed_mm"])
        maps = sorted(path.name for path in (blood_pool() / "measures").glob("polar_*.svg"))
        self.assertIn("polar_motion_mm.svg", maps)
        self.assertFalse([name for name in maps if "perfusion" in name or "thick" in name or "counts" in name], maps)

    def test_has_no_perfusion_to_score_and_volumes_to_compare(self):
        self.refuses(2, "perfusion", "score", blood_pool(), says="has no perfusion")
        self.refuses(2, "solid", blood_pool(), "--out", self.folder / "wall.vtu", says="no wall")
        out = self.folder / "both"
        made = run("perfusion", "compare", blood_pool(), blood_pool(), "--out", out)
        self.assertEqual(made.returncode, 0, made.stderr)
        both = self.read_json(out / "comparison.json")
        self.assertEqual(both["tid_ratio"], 1)
        self.assertIsNone(both["summed_rest_score"])
        page = (out / "comparison.html").read_text()
        self.assertIn("Inward motion, rest less stress", page)
        self.assertNotIn("Perfusion", page)
        self.refuses(2, "perfusion", "compare", blood_pool(), small_result(), says="has no perfusion")


class Compare(CliTest):
    def test_a_wider_stress_heart_with_a_defect_shows_in_ratio_and_difference(self):
        rest = result_of("normal1", "--seed", "2", "--set", "edv_ml=110")
        stress = result_of("sick", "--seed", "9", "--set", "defect=inferior", "--set", "defect_extent_deg=70")
        out = self.folder / "both"
        made = run("perfusion", "compare", rest, stress, "--out", out, "--json", "--with-names")
        self.assertEqual(made.returncode, 0, made.stderr)
        both = self.read_json(out / "comparison.json")
        self.assertEqual(both, json.loads(made.stdout))
        lost = {s["number"]: s["perfusion_lost_points"] for s in both["segments"]}
        self.assertGreater(lost[10], 20)
        self.assertLess(abs(lost[7]), 12)
        self.assertGreater(both["summed_difference_score"], 0)
        same = json.loads(run("perfusion", "compare", rest, rest, "--json").stdout)
        self.assertEqual(same["tid_ratio"], 1)
        self.assertEqual(same["summed_difference_score"], 0)
        self.assertIn("<svg", (out / "polar_difference.svg").read_text())
        page = (out / "comparison.html").read_text()
        self.assertEqual(page.count("<svg"), 1 + 3 * 3, "a curve and three maps of each study with their difference")
        for text in (f"<b>{both['tid_ratio']:.2f}</b>", "rest less stress", f"normals/{rest.name}/report.html", "mid inferior",
                     "Research use only", "default-src 'none'"):
            self.assertIn(text, page)
        self.assertNotIn("nan", re.sub("base64,[^\"]*", "", page))  # a picture's letters may be any
        self.assertNotRegex(page, "<script|<iframe")
        pictures = [base64.b64decode(text) for text in re.findall('<img [^>]*src="data:image/png;base64,([^"]*)"', page)]
        self.assertEqual(pictures, [(study / "measures" / "splash.png").read_bytes() for study in (rest, stress)])
        self.assertNotIn("<style>text", page, "a style of one picture holds for the whole page")
        again = run("perfusion", "compare", rest, stress, "--out", out)
        self.assertEqual(again.returncode, 0, again.stderr)  # a former comparison is replaced
        self.refuses(1, "perfusion", "compare", rest, stress, "--pdf", says="expected --out")

    def test_refuses_what_is_no_result(self):
        self.refuses(2, "perfusion", "compare", small_result(), self.folder, says="results.json")


class Solid(CliTest):
    def test_fills_the_wall_in_three_formats(self):
        for ending, begins in (("vtu", b"<?xml"), ("msh", b"$MeshFormat\n2.2 0 8"), ("inp", b"*HEADING")):
            out = shared_folder() / f"wall.{ending}"
            made = run("solid", small_result(), "--gate", "1", "--out", out)
            self.assertEqual(made.returncode, 0, made.stdout + made.stderr)
            self.assertTrue(out.read_bytes().startswith(begins))
            self.assertRegex(made.stdout, r"not positive +0\n")

    def test_fills_the_fitted_wall_where_there_is_one(self):
        result, out = small_result(), shared_folder() / "fitted.vtu"
        gate = json.loads((result / "results.json").read_text())["gates"][0]
        held = {}
        for kind, more in (("PSF-corrected", []), ("edge", ["--edges"])):
            made = run("solid", result, "--out", out, "--replace", *more)
            self.assertEqual(made.returncode, 0, made.stdout + made.stderr)
            self.assertIn(kind, made.stdout)
            self.assertRegex(made.stdout, r"not positive +0\n")
            held[kind] = float(re.search(r"volume_ml +([0-9.]+)", made.stdout)[1])
        # The solid ends a little below the valve plane.
        self.assertAlmostEqual(held["PSF-corrected"] / (gate["epi_ml"] - gate["endo_ml"]), 1, delta=0.15)
        self.assertGreater(held["edge"], 1.1 * held["PSF-corrected"], "edges make the wall thick")

    def test_refuses_what_is_not_there(self):
        out = shared_folder() / "no.vtu"
        self.assertEqual(run("solid", small_result(), "--gate", "99", "--out", out).returncode, 1)
        self.assertEqual(run("solid", shared_folder(), "--out", out).returncode, 2)
        self.assertEqual(run("solid", small_result(), "--out", shared_folder() / "wall.txt").returncode, 1)
        self.assertFalse(out.exists())


if __name__ == "__main__":
    unittest.main()
