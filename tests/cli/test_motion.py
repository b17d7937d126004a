"""Twist and strain from tracked points."""

import functools
import re
import unittest

from cli import CliTest, SMALL_PATIENT, run, shared_folder, small_patient, small_result


@functools.cache
def tagged(twist=19):
    """A virtual patient with 150 tracked points, each known to 0.3 mm."""
    folder = shared_folder() / f"tagged{twist}"
    made = run("phantom", "patient", "--out", folder, "--seed", 7, *SMALL_PATIENT, "--set", "gates=8",
               "--set", "tags.points=150", "--set", f"tags.twist_deg={twist}")
    assert made.returncode == 0, made.stderr
    return folder


def place(vector):
    return ",".join(str(v) for v in vector)


class Motion(CliTest):
    def axis(self, truth):
        return ["--apex", place(truth["apex_mm"]), "--base", place(truth["base_mm"])]

    def test_recovers_a_synthetic_twist_within_2_degrees(self):
        for twist in (18, 20, -12):
            truth = self.read_json(tagged(twist) / "truth.json")["tracked"]
            out = self.folder / f"motion{twist}"
            made = run("motion", tagged(twist) / "points.csv", *self.axis(truth), "--out", out)
            self.assertEqual(made.returncode, 0, made.stderr)
            self.assertIn("largest twist", made.stdout)
            results = self.read_json(out / "results.json")
            self.assertEqual(results["schema"], "dynasurf.motion/1")
            self.assertEqual([gate["gate"] for gate in results["gates"]], list(range(1, 9)))
            for gate, true in zip(results["gates"], truth["twist_deg"]):
                self.assertAlmostEqual(gate["twist_deg"], true, delta=2)
            largest = max(truth["twist_deg"], key=abs)
            self.assertAlmostEqual(results["peak"]["twist_deg"], largest, delta=2)
            self.assertGreater(abs(largest), 0.9 * abs(twist))
            low, high = results["peak"]["twist_deg_90"]
            self.assertLess(low, results["peak"]["twist_deg"])
            self.assertLess(high - low, 4)
            # A heart that contracts gets shorter around and along, and thicker.
            self.assertLess(results["peak"]["circumferential_percent"], -5)
            self.assertLess(results["peak"]["longitudinal_percent"], -2)
            self.assertGreater(results["peak"]["radial_percent"], 5)
            picture = (out / "motion.svg").read_text()
            self.assertEqual(len(re.findall(r'<path d="M[^"]*L', picture)), 7)

    def test_carries_the_surfaces_of_a_result_along(self):
        study, result, out = tagged() / "study.dcm", shared_folder() / "tagged-result", self.folder / "motion"
        self.assertIn(run("ventricle", study, "--out", result).returncode, (0, 3))
        made = run("motion", tagged() / "points.csv", "--result", result, "--out", out)
        self.assertEqual(made.returncode, 0, made.stderr)
        motion, truth = self.read_json(out / "results.json"), self.read_json(tagged() / "truth.json")
        # The axis is the one that was found, and the twist is that of the points.
        self.assertAlmostEqual(motion["peak"]["twist_deg"], max(truth["tracked"]["twist_deg"]), delta=2)
        first = self.read_json(result / "results.json")["gates"][0]
        self.assertAlmostEqual(motion["gates"][0]["cavity_ml"], first["endo_ml"], delta=1e-6)
        true = [gate["endo_ml"] for gate in truth["gates"]]
        first = motion["gates"][0]["cavity_ml"]
        for gate, volume in zip(motion["gates"], true):
            # Points within the wall and as far apart as it is thick hold its inner side back: measured, by a sixth; their
            # errors of 0.3 mm are 2 mL.
            self.assertAlmostEqual(first - gate["cavity_ml"], true[0] - volume, delta=0.25 * (true[0] - volume) + 3)
        self.assertTrue((out / "meshes" / "endo_g08.vtp").exists())
        self.assertTrue((out / "meshes" / "epi_g01.ply").exists())

    def test_gives_the_same_bytes_for_any_number_of_threads(self):
        truth = self.read_json(tagged() / "truth.json")["tracked"]
        texts = []
        for threads in (1, 3):
            out = self.folder / f"with{threads}"
            run("motion", tagged() / "points.csv", *self.axis(truth), "--threads", threads, "--out", out)
            texts.append((out / "results.json").read_bytes() + (out / "motion.svg").read_bytes())
        self.assertEqual(*texts)

    def test_says_what_is_wrong_in_one_line(self):
        points, out = tagged() / "points.csv", self.folder / "motion"
        self.refuses(1, "motion", points, "--out", out, says="expected --result, or --apex and --base")
        self.refuses(1, "motion", points, "--apex", "1,2,3", "--out", out, says="belong together")
        self.refuses(1, "motion", points, "--apex", "1,2", "--base", "1,2,9", "--out", out, says="--apex")
        self.refuses(2, "motion", points, "--apex", "1,2,3", "--base", "1,2,3", "--out", out, says="long axis")
        self.refuses(2, "motion", points, "--result", small_patient(), "--out", out, says="results.json")
        self.refuses(1, "motion", points, "--apex", "0,0,0", "--base", "0,0,80", "--rest-gate", 9, "--out", out,
                     says="gate 9")
        bad = self.folder / "bad.csv"
        bad.write_text("point,gate,x,y,z\n1,1,0,0,nan\n")
        self.refuses(2, "motion", bad, "--apex", "0,0,0", "--base", "0,0,80", "--out", out, says=("bad.csv", "line 2"))
        self.refuses(2, "motion", self.folder / "none.csv", "--apex", "0,0,0", "--base", "0,0,80", "--out", out,
                     says="none.csv")
        self.assertFalse(out.exists())


if __name__ == "__main__":
    unittest.main()
