"""Studies and meshes: what `info`, `phantom` and `measure` say, and what they refuse."""

import json
import os
import unittest

from cli import KINDS, SMALL_PATIENT, CliTest, hashes, run, small_patient

CUBE = """OFF
8 12 0
0 0 0
10 0 0
10 10 0
0 10 0
0 0 10
10 0 10
10 10 10
0 10 10
3 0 2 1
3 0 3 2
3 4 5 6
3 4 6 7
3 0 1 5
3 0 5 4
3 1 2 6
3 1 6 5
3 2 3 7
3 2 7 6
3 3 0 4
3 3 4 7
"""


class Info(CliTest):
    def test_tells_what_a_study_holds(self):
        for name in ("study.dcm", "study.nii.gz"):
            done = run("info", small_patient() / name)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("40", done.stdout)
            self.assertRegex(done.stdout, r"gates +4")

    def test_prints_json(self):
        facts = json.loads(run("info", small_patient() / "study.dcm", "--json").stdout)
        self.assertEqual(facts["modality"], "NM")

    def test_refuses_what_is_no_study(self):
        self.refuses(2, "info", self.folder / "missing.dcm", says="missing.dcm")
        (self.folder / "empty.dcm").write_bytes(b"")
        self.refuses(2, "info", self.folder / "empty.dcm", says="empty.dcm")
        junk = self.folder / "junk"
        junk.mkdir()
        self.refuses(2, "info", junk, says="junk")
        (junk / "a.txt").write_text("not a heart")
        (junk / "b.bin").write_bytes(bytes(range(256)) * 20)
        self.refuses(2, "info", junk, says="junk")
        self.refuses(2, "info", junk / "b.bin", says="b.bin")

    def test_refuses_a_study_cut_in_the_middle(self):
        for name in ("study.dcm", "study.nii.gz"):
            whole = (small_patient() / name).read_bytes()
            for part in (0.01, 0.3, 0.7, 0.999):
                cut = self.folder / name
                cut.write_bytes(whole[:int(len(whole) * part)])
                self.refuses(2, "info", cut, says=name)

    def test_shows_no_control_characters_of_a_file_name(self):
        line = self.refuses(2, "info", self.folder / "bad\x1b[31m\nname.dcm")
        self.assertNotIn("\x1b", line)


class Phantom(CliTest):
    def test_writes_study_truth_and_surfaces(self):
        files = set(hashes(small_patient()))
        self.assertLessEqual({"study.dcm", "study.nii.gz", "truth.json", "truth/endo_g01.ply", "truth/epi_g04.ply"}, files)
        truth = self.read_json(small_patient() / "truth.json")
        self.assertEqual(len(truth["gates"]), 4)
        ef = 100 * (truth["edv_ml"] - truth["esv_ml"]) / truth["edv_ml"]
        self.assertAlmostEqual(truth["ef_percent"], ef, places=6)
        self.assertEqual(truth["options"]["noise"]["seed"], 7)

    def test_makes_every_kind(self):
        for kind in KINDS.split(", "):
            done = run("phantom", kind, "--out", self.folder / kind)
            self.assertEqual(done.returncode, 0, f"{kind}: {done.stderr}")
            self.assertTrue((self.folder / kind / "study.dcm").is_file(), kind)

    def test_gives_the_same_bytes_for_the_same_seed_and_any_number_of_threads(self):
        for threads in (1, 2, 8):
            run("phantom", "patient", "--seed", 7, "--threads", threads, "--out", self.folder / str(threads), *SMALL_PATIENT)
            self.assertEqual(hashes(self.folder / str(threads)), hashes(small_patient()))
        run("phantom", "patient", "--seed", 8, "--out", self.folder / "other", *SMALL_PATIENT)
        self.assertNotEqual(hashes(self.folder / "other")["study.dcm"], hashes(small_patient())["study.dcm"])

    def test_writes_nrrd_when_asked(self):
        run("phantom", "hebron", "--nrrd", "--out", self.folder / "h")
        self.assertEqual(run("info", self.folder / "h" / "study.nrrd").returncode, 0)

    def test_makes_beats_of_one_and_two_gates_that_can_be_read(self):
        for gates in (1, 2):
            folder = self.folder / str(gates)
            made = run("phantom", "patient", "--seed", 7, "--out", folder, *SMALL_PATIENT, "--set", f"gates={gates}")
            self.assertEqual(made.returncode, 0, made.stderr)
            truth = self.read_json(folder / "truth.json")
            self.assertEqual(len(truth["gates"]), gates)
            self.assertEqual(len(truth["regions"]["segments"]), 17)
            self.assertIsNone(truth["regions"]["phase"]["motion"])
            read = run("ventricle", folder / "study.dcm", "--out", folder / "result")
            self.assertEqual(read.returncode, 0, read.stdout + read.stderr)
            results = self.read_json(folder / "result" / "results.json")
            for gate, true in zip(results["gates"], truth["gates"], strict=True):
                # A coarse lattice and few counts: within a quarter is in the right place.
                self.assertAlmostEqual(gate["endo_ml"] / true["endo_ml"], 1, delta=0.25)

    SMALL_CAMERA = ["--seed", 5, "--set", "heart.gates=2", "--set", "acquisition.size=32", "--set", "acquisition.bin_mm=12.8",
                    "--set", "acquisition.views=16", "--set", "acquisition.million_counts=0.5", "--set", "reorientation.size=32"]

    def test_puts_a_patient_before_a_camera(self):
        for name, threads in (("one", 1), ("two", 2)):
            made = run("phantom", "camera", "--threads", threads, "--out", self.folder / name, *self.SMALL_CAMERA)
            self.assertEqual(made.returncode, 0, made.stderr)
        self.assertEqual(hashes(self.folder / "one"), hashes(self.folder / "two"))
        files = {"projections.dcm", "transaxial.dcm", "study.dcm", "attenuation.nrrd", "truth.json", "truth/endo_g02.ply"}
        self.assertLessEqual(files, set(hashes(self.folder / "one")))
        truth = self.read_json(self.folder / "one" / "truth.json")
        self.assertEqual((truth["kind"], len(truth["gates"]), len(truth["camera"]["angle_deg"])), ("camera", 2, 16))
        for study in ("transaxial.dcm", "study.dcm", "attenuation.nrrd"):
            self.assertEqual(run("info", self.folder / "one" / study).returncode, 0)
        self.refuses(2, "info", self.folder / "one" / "projections.dcm", says="TOMO")

    def test_refuses_a_camera_inside_the_patient_and_subsets_that_do_not_divide_its_views(self):
        out = self.folder / "p"
        self.refuses(1, "phantom", "camera", "--out", out, "--set", "acquisition.radius_mm=100", says="radius_mm is 100")
        self.refuses(1, "phantom", "camera", "--out", out, *self.SMALL_CAMERA, "--set", "reconstruction.subsets=5",
                     says="subsets is 5; expected a divisor")
        self.refuses(1, "phantom", "camera", "--out", out, "--set", "heart.fwhm_mm=8", says="unknown option")
        self.assertFalse(out.exists())

    def test_refuses_unknown_kinds_options_and_seeds(self):
        out = self.folder / "p"
        self.refuses(1, "phantom", "patiant", "--out", out, says="did you mean 'patient'?")
        self.refuses(1, "phantom", "patient", "--out", out, "--set", "edv=100", says="did you mean 'edv_ml'?")
        self.refuses(1, "phantom", "patient", "--out", out, "--set", "edv_ml=-3", says="edv_ml is '-3'; expected a number >= 5")
        self.refuses(1, "phantom", "sphere", "--out", out, "--seed", 3, says="draws no random numbers")
        self.refuses(1, "phantom", "patient", "--out", out, "--seed=-1", says="noise.seed is '-1'; expected a whole number >= 0")
        self.assertFalse(out.exists())

    def test_replaces_a_former_phantom_but_no_folder_of_the_user(self):
        out = self.folder / "p"
        for _ in range(2):
            self.assertEqual(run("phantom", "sphere", "--out", out).returncode, 0)
        mine = self.folder / "mine"
        mine.mkdir()
        (mine / "thesis.txt").write_text("years of work")
        self.refuses(2, "phantom", "sphere", "--out", mine, says="mine")
        self.assertEqual((mine / "thesis.txt").read_text(), "years of work")


class Measure(CliTest):
    def test_measures_a_cube(self):
        cube = self.folder / "cube.off"
        cube.write_text(CUBE)
        measured = json.loads(run("measure", cube, "--json").stdout)
        self.assertAlmostEqual(measured["volume_ml"], 1.0, places=12)
        self.assertAlmostEqual(measured["volume_by_quadrature_ml"], 1.0, places=12)
        self.assertAlmostEqual(measured["area_mm2"], 600.0, places=9)
        self.assertEqual((measured["vertices"], measured["edges"], measured["triangles"], measured["euler"]), (8, 18, 12, 2))
        self.assertTrue(measured["closed"] and measured["oriented"] and measured["manifold"])
        self.assertEqual((measured["self_intersections"], measured["flat_triangles"]), (0, 0))
        self.assertIn("volume_ml", run("measure", cube).stdout)

    def test_counts_triangles_that_cut_each_other(self):
        crossed = self.folder / "crossed.off"
        crossed.write_text("OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n1 1 -1\n1 1 1\n2 2 1\n3 0 1 2\n3 3 4 5\n")
        measured = json.loads(run("measure", crossed, "--json").stdout)
        self.assertEqual((measured["self_intersections"], measured["manifold"]), (1, True))

    def test_gives_no_volume_to_an_open_surface(self):
        lines = CUBE.splitlines()
        lines[1] = "8 11 0"
        opened = self.folder / "open.off"
        opened.write_text("\n".join(lines[:-1]) + "\n")
        measured = json.loads(run("measure", opened, "--json").stdout)
        self.assertIsNone(measured["volume_ml"])
        self.assertFalse(measured["closed"])

    def test_agrees_with_the_truth_of_a_phantom(self):
        truth = self.read_json(small_patient() / "truth.json")
        measured = json.loads(run("measure", small_patient() / "truth" / "endo_g01.ply", "--json").stdout)
        # The mesh is inscribed into the smooth surface whose volume is told.
        self.assertAlmostEqual(measured["volume_ml"] / truth["gates"][0]["endo_ml"], 1, delta=0.005)

    def test_refuses_what_is_no_mesh(self):
        self.refuses(2, "measure", self.folder / "missing.ply", says="missing.ply")
        for name in ("empty.ply", "empty.stl", "empty.obj", "empty.off"):
            (self.folder / name).write_bytes(b"")
            self.refuses(2, "measure", self.folder / name, says=name)
        (self.folder / "cut.off").write_text(CUBE[:-30])
        self.refuses(2, "measure", self.folder / "cut.off", says="cut.off")
        self.refuses(2, "measure", self.folder, says=str(self.folder))

    @unittest.skipIf(os.geteuid() == 0, "root may read everything")
    def test_refuses_what_it_may_not_read(self):
        secret = self.folder / "secret.ply"
        secret.write_text("ply\n")
        secret.chmod(0)
        self.refuses(2, "measure", secret, says="secret.ply")


class OrganCommand(CliTest):
    def test_surrounds_a_label_with_a_closed_surface(self):
        scan, out = self.folder / "scan", self.folder / "organ"
        made = run("phantom", "organ", "--out", scan, "--set", "values=labels", "--set", "shape=prostate",
                   "--set", "lattice.dx_mm=1.4", "--set", "lattice.dy_mm=1.4", "--set", "lattice.dz_mm=3",
                   "--set", "lattice.nz=26")
        self.assertEqual(made.returncode, 0, made.stderr)
        made = run("organ", scan / "study.nii.gz", "--out", out, "--label", 1)
        self.assertEqual(made.returncode, 0, made.stdout + made.stderr)
        result = json.loads((out / "results.json").read_text())
        truth = json.loads((scan / "truth.json").read_text())["gates"][0]["epi_ml"]
        self.assertEqual(result["schema"], "dynasurf.organ/1")
        self.assertAlmostEqual(result["surface"]["volume_ml"] / truth, 1, delta=0.03)
        self.assertRegex(run("measure", out / "organ.ply").stdout, r"closed +true")
        self.assertTrue((out / "slices.png").read_bytes().startswith(b"\x89PNG"))
        before = hashes(out)
        self.assertEqual(run("organ", scan / "study.nii.gz", "--out", out, "--label", 1, "--threads", 1).returncode, 0)
        self.assertEqual(hashes(out), before)

    def test_refuses_what_it_cannot_do(self):
        self.refuses(1, "organ", small_patient() / "study.dcm", "--out", self.folder / "o", "--preset", "xray",
                     says="choices")
        self.refuses(1, "organ", small_patient() / "study.dcm", "--out", self.folder / "o", "--gate", 9, says="1 to 4")
        empty = run("organ", small_patient() / "study.dcm", "--out", self.folder / "o", "--label", 999999)
        self.assertEqual(empty.returncode, 3, empty.stdout + empty.stderr)


if __name__ == "__main__":
    unittest.main()
