"""Studies with a fault that a person would overlook: read, with a note, and the same in `info` and `ventricle`."""

import array
import gzip
import json
import math
import os
import shutil
import struct
import unittest

from cli import EDGES, CliTest, run, small_patient, small_result
from studies import with_elements, with_implicit_kinds


def changed_study(path, change):
    """A copy of the small patient whose values `change(values, nx, ny, nz)` has changed."""
    volume = gzip.decompress((small_patient() / "study.nii.gz").read_bytes())
    values = array.array("f", volume[352:])
    change(values, *struct.unpack_from("<3h", volume, 42))
    path.write_bytes(volume[:352] + values.tobytes())


def series(folder, name, number, description):
    """The small patient as a series of its own, beside others."""
    folder.mkdir(exist_ok=True)
    elements = {(0x0008, 0x0018): ("UI", f"2.25.8{number}"), (0x0008, 0x103E): ("LO", description),
                (0x0020, 0x000E): ("UI", f"2.25.9{number}"), (0x0020, 0x0011): ("IS", str(number))}
    (folder / name).write_bytes(with_elements((small_patient() / "study.dcm").read_bytes(), elements))


class Faults(CliTest):
    def reads(self, study, *arguments):
        """The result, and the codes of the notes that `info` tells of it."""
        told = run("info", study, "--json")
        self.assertEqual(told.returncode, 0, told.stderr)
        done = run("ventricle", study, "--out", self.folder / "r", *EDGES, *arguments)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return self.read_json(self.folder / "r/results.json"), [n["code"] for n in json.loads(told.stdout)["notes"]]

    def usual(self):
        return self.read_json(small_result() / "results.json")["readings"]["edge"]

    def test_a_hot_voxel_changes_nothing(self):
        def change(values, nx, ny, nz):
            values[nx * ny * nz + (nz - 3) * nx * ny + 3 * nx + 3] = 30 * max(values)
        changed_study(self.folder / "hot.nii", change)
        results, notes = self.reads(self.folder / "hot.nii")
        self.assertEqual(notes, ["study.hot_voxel"])
        self.assertAlmostEqual(results["edv_ml"], self.usual()["edv_ml"], delta=0.1)
        self.assertAlmostEqual(results["esv_ml"], self.usual()["esv_ml"], delta=0.1)

    def test_noise_below_0_is_stored_as_0_where_counts_are(self):
        done = run("phantom", "patient", "--seed", "1", "--set", "gates=2", "--set", "noise.gaussian_percent=30", "--out",
                   self.folder / "noisy")
        self.assertEqual(done.returncode, 0, done.stderr)
        values = gzip.decompress((self.folder / "noisy/study.nii.gz").read_bytes())[352:]
        self.assertLess(min(array.array("f", values)), 0, "NIfTI keeps all")

    def test_one_line_says_what_to_look_at(self):
        def noise(values, nx, ny, nz):
            for n in range(len(values)):
                values[n] = (n * 2654435761 >> 7) % 1000
        changed_study(self.folder / "noise.nii", noise)
        done = run("ventricle", "noise.nii", "--out", "r", cwd=self.folder)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertEqual(sum("look at: " in line for line in done.stdout.splitlines()), 1, done.stdout)
        self.assertIn("verdict: fail\n  look at: ", done.stdout)
        self.assertIn("--center", done.stdout)
        self.assertNotIn("The endo border was found in no slice", done.stdout, "the gates are named in one line")
        good = run("ventricle", small_patient() / "study.nii.gz", "--out", "good", cwd=self.folder)
        self.assertIn("verdict: ok\n", good.stdout)
        self.assertNotIn("look at: ", good.stdout)

    def test_files_that_tell_the_kinds_of_their_values_need_no_dictionary(self):
        (self.folder / "explicit.dcm").write_bytes((small_patient() / "study.dcm").read_bytes())
        (self.folder / "implicit.dcm").write_bytes(with_implicit_kinds((small_patient() / "study.dcm").read_bytes()))
        usual = run("info", "explicit.dcm", cwd=self.folder)
        self.assertEqual(usual.returncode, 0, usual.stderr)
        implicit = run("info", "implicit.dcm", cwd=self.folder)
        self.assertEqual(implicit.stdout.replace("implicit", "explicit"), usual.stdout)
        without = dict(os.environ, DCMDICTPATH=str(self.folder / "nothing"))
        self.assertEqual(run("info", "explicit.dcm", cwd=self.folder, env=without).stdout, usual.stdout)
        refused = run("info", "implicit.dcm", cwd=self.folder, env=without)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("dictionary dicom.dic is not found", refused.stderr)

    def test_an_empty_gate_is_bridged_and_doubted(self):
        def change(values, nx, ny, nz):
            count = nx * ny * nz
            values[3 * count:4 * count] = array.array("f", bytes(4 * count))
        changed_study(self.folder / "empty.nii", change)
        results, notes = self.reads(self.folder / "empty.nii")
        self.assertEqual(notes, ["study.empty_gate"])
        self.assertEqual(results["quality"]["verdict"], "check")
        self.assertIn("study.empty_gate", [flag["code"] for flag in results["quality"]["flags"]])
        self.assertAlmostEqual(results["edv_ml"], self.usual()["edv_ml"], delta=2)

    def test_values_that_are_no_numbers_outside_a_round_field_are_nothing(self):
        def change(values, nx, ny, _nz):
            for v in range(len(values)):
                if math.hypot(v % nx - nx / 2 + 0.5, v // nx % ny - ny / 2 + 0.5) > nx / 2:
                    values[v] = math.nan
        changed_study(self.folder / "round.nii", change)
        results, notes = self.reads(self.folder / "round.nii")
        self.assertEqual(notes, ["study.not_finite"])
        self.assertAlmostEqual(results["edv_ml"], self.usual()["edv_ml"], delta=0.1)

    def test_the_same_file_twice_is_one_study(self):
        (self.folder / "study").mkdir()
        for name in ("a.dcm", "b.dcm"):
            shutil.copy(small_patient() / "study.dcm", self.folder / "study" / name)
        results, notes = self.reads(self.folder / "study")
        self.assertEqual(notes, ["dicom.copies"])
        self.assertEqual(results["edv_ml"], self.usual()["edv_ml"])
        self.assertEqual(len(results["provenance"]["inputs"]), 1)

    def test_rest_and_stress_are_listed_and_chosen(self):
        study = self.folder / "study"
        series(study, "a.dcm", 301, "CANARY^HANS STRESS")
        series(study, "b.dcm", 201, "CANARY^HANS REST")
        line = self.refuses(2, "ventricle", study, "--out", self.folder / "r",
                            says=("2 different image stacks", "--series", "201 is 4 gates of ",
                                  "rest; 301 is 4 gates of ", "stress"))
        listed = run("info", study).stdout
        self.assertRegex(listed, r"^2 studies\na.dcm +4 gates of .*, stress *\nb.dcm +4 gates of .*, rest *\n$")
        studies = json.loads(run("info", study, "--json").stdout)["studies"]
        self.assertEqual([s["files"] for s in studies], [["a.dcm"], ["b.dcm"]])
        self.assertEqual(len({s["examination"] for s in studies}), 1)
        self.assertNotIn("CANARY", line + listed)
        os.rename(study / "a.dcm", os.fsencode(study) + b"/a\xe9\n\x1b[31m.dcm")
        listed = run("info", study)
        self.assertEqual(listed.returncode, 0, listed.stderr)
        self.assertEqual(len(listed.stdout.splitlines()), 3)
        self.assertNotIn("\x1b", listed.stdout)
        studies = json.loads(run("info", study, "--json").stdout)["studies"]
        self.assertIn(["a\\xe9\n\x1b[31m.dcm"], [s["files"] for s in studies])
        self.refuses(1, "info", study, "--picture", says="--json")
        os.rename(os.fsencode(study) + b"/a\xe9\n\x1b[31m.dcm", study / "a.dcm")
        self.refuses(2, "info", study, "--series", "5", says="201 is 4 gates")
        self.refuses(2, "info", small_patient() / "study.nii.gz", "--series", "1", says="no series to choose from")
        self.assertIn("number 201, which --series chose, is read", run("info", study, "--series", "rest").stdout)
        for words in ("canary^hans rest", "201", "2.25.9201"):
            done = run("ventricle", study, "--series", words, "--out", self.folder / "r", *EDGES)
            self.assertEqual(done.returncode, 0, done.stderr)
            provenance = self.read_json(self.folder / "r/results.json")["provenance"]
            self.assertEqual(provenance["given"]["series"], "201")
            self.assertTrue(provenance["command"].endswith(" --series 201"), provenance["command"])
        again = run("rerun", self.folder / "r")
        self.assertEqual(again.returncode, 0, again.stdout + again.stderr)
        self.assertIn("same bytes", again.stdout)

    def test_a_segmentation_of_slicer_is_a_mask_and_a_label_map(self):
        volume = gzip.decompress((small_patient() / "study.nii.gz").read_bytes())
        nx, ny, nz = struct.unpack_from("<3h", volume, 42)
        rows = [struct.unpack_from("<4f", volume, 280 + 16 * row) for row in range(3)]  # RAS
        vectors = [f"({-rows[0][c]!r},{-rows[1][c]!r},{rows[2][c]!r})" for c in range(4)]
        inside = bytes(all(4 <= x < n - 4 for x, n in ((i, nx), (j, ny))) for _ in range(nz) for j in range(ny)
                       for i in range(nx))
        header = (f"NRRD0004\ntype: unsigned char\ndimension: 3\nspace: left-posterior-superior\nsizes: {nx} {ny} {nz}\n"
                  f"space directions: {' '.join(vectors[:3])}\nkinds: domain domain domain\nencoding: gzip\n"
                  f"space origin: {vectors[3]}\nSegment0_ID:=Segment_1\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n\n")
        mask = self.folder / "heart.seg.nrrd"
        mask.write_bytes(header.encode() + gzip.compress(inside))
        self.assertIn("nrrd.segmentation", run("info", mask).stdout)
        results, _ = self.reads(small_patient() / "study.nii.gz", "--mask", mask)
        self.assertAlmostEqual(results["edv_ml"], self.usual()["edv_ml"], delta=2)


if __name__ == "__main__":
    unittest.main()
