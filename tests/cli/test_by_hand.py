"""What a person says in place of what was found: values, a mask, a decision."""

import json
import shlex
import unittest

from cli import EDGES, CliTest, hashes, run, small_patient, small_result, write_mask


class ByHand(CliTest):
    def test_what_a_person_says_is_followed_and_recorded(self):
        found = self.read_json(small_result() / "results.json")["heart"]
        said = {"center": [c + 1 for c in found["center_mm"]], "axis": found["axis"], "radius": 45, "first-slice": 3,
                "last-slice": 22, "base-plane": 95}
        arguments = []
        for name, value in said.items():
            arguments += ["--" + name, *(value if isinstance(value, list) else [value])]
        done = run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", *arguments, *EDGES)
        self.assertIn(done.returncode, (0, 3), done.stdout + done.stderr)
        manual = self.read_json(self.folder / "r" / "options.json")["manual"]
        for n in range(3):
            self.assertAlmostEqual(manual["center_mm"][n], said["center"][n], places=6)
            self.assertAlmostEqual(manual["axis"][n], said["axis"][n], places=6)
        self.assertEqual([manual[name] for name in ("radius_mm", "first_slice", "last_slice", "base_plane_mm")],
                         [45, 3, 22, 95])
        results = self.read_json(self.folder / "r" / "results.json")
        self.assertIn("manual.base_plane_mm=95", results["provenance"]["command"])
        planes = {json.dumps(gate["base_plane"]["point_mm"] + gate["base_plane"]["normal"]) for gate in results["gates"]}
        self.assertEqual(len(planes), 1, "the same in all gates")

    def test_all_readings_end_where_a_person_moves_the_valve_plane(self):
        done = run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--set",
                   "manual.base_shift_mm=-6", "--set", "manual.exclude_gates=3")
        self.assertIn(done.returncode, (0, 3), done.stdout + done.stderr)
        moved = self.read_json(self.folder / "r" / "results.json")
        self.assertIn("gate.excluded", [note["code"] for note in moved["notes"]])
        before = self.read_json(small_result() / "results.json")["readings"]
        self.assertEqual(set(moved["readings"]), set(before))
        for name, reading in moved["readings"].items():
            less = before[name]["edv_ml"] - reading["edv_ml"]
            self.assertTrue(3 < less < 20, f"{name}: {less} mL less")  # 6 mm of a cavity 25 to 55 mm wide

    def test_a_readers_decision_is_recorded_and_changes_no_number(self):
        words = ["manual.decision=accepted", "manual.reader=A. O'Reader", "manual.comment=apex well seen"]
        done = run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r",
                   *(word for setting in words for word in ("--set", setting)))
        self.assertIn(done.returncode, (0, 3), done.stdout + done.stderr)
        results, before = (self.read_json(folder / "results.json") for folder in (self.folder / "r", small_result()))
        self.assertEqual([results["provenance"]["options"]["manual"][key] for key in ("decision", "reader", "comment")],
                         [word.split("=")[1] for word in words])
        told = shlex.split(results["provenance"]["command"])
        self.assertEqual([told[n + 1] for n, word in enumerate(told) if word == "--set"], words)
        for result in (results, before):
            for key in ("provenance", "timings_s"):
                result.pop(key, None)
        self.assertEqual(results, before)

    def test_what_a_person_cannot_mean_is_refused(self):
        for says, arguments in (("inside the volume", ["--center", "500", "500", "500"]),
                                ("At least 3", ["--center", "1", "2"]), ("no length", ["--axis", "0", "0", "0"]),
                                ("radius_mm", ["--radius", "-3"]), ("first_slice", ["--first-slice", "0"]),
                                ("short-axis stack", ["--last-slice", "900"]),
                                ("after the last", ["--first-slice", "9", "--last-slice", "4"]),
                                ("base_plane_mm", ["--base-plane", "900"]), ("base_plane_mm", ["--base-plane", "nan"])):
            self.refuses(1, "ventricle", small_patient() / "study.dcm", "--out", self.folder / "no", "--quiet", *arguments,
                         says=says)

    def test_a_mask_is_applied_recorded_and_repeated(self):
        write_mask(small_patient() / "study.nii.gz", self.folder / "mask.nii",
                   lambda i, j: (i - 19.5) ** 2 + (j - 19.5) ** 2 < 13 ** 2)
        done = run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--mask",
                   self.folder / "mask.nii", *EDGES)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        results = self.read_json(self.folder / "r" / "results.json")
        self.assertIn("region.used", [note["code"] for note in results["notes"]])
        self.assertEqual(results["provenance"]["given"],
                         {"mask_sha256": hashes(self.folder)["mask.nii"], "start_mesh_sha256": None})
        self.assertIn("--mask MASK", results["provenance"]["command"])
        again = run("rerun", self.folder / "r", "--study", small_patient() / "study.dcm")
        self.assertEqual(again.returncode, 0, again.stdout + again.stderr)
        (self.folder / "mask.nii").unlink()
        self.refuses(2, "rerun", self.folder / "r", "--study", small_patient() / "study.dcm", says="--mask",
                     cwd=self.folder)

    def test_a_mask_must_be_one_volume_over_the_study(self):
        self.refuses(2, "ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--mask",
                     small_patient() / "study.dcm", "--quiet", says="expected a mask of one")
        write_mask(small_patient() / "study.nii.gz", self.folder / "none.nii", lambda i, j: False)
        self.refuses(2, "borders", small_patient() / "study.dcm", "--out", self.folder / "r", "--mask",
                     self.folder / "none.nii", "--quiet", says="covers no voxel")


if __name__ == "__main__":
    unittest.main()
