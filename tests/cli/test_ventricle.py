"""The main job from the command line: what it leaves, that it is the same every time, and its bad days."""

import array
import gzip
import json
import pathlib
import re
import resource
import shutil
import signal
import struct
import subprocess
import time
import unittest

from cli import EDGES, PROGRAM, SMALL_PATIENT, CliTest, hashes, run, small_patient, small_result
from studies import empty_study, with_elements

# A run that takes long, so that it can be disturbed.
SLOW = ["--set", "mesh_level=4", "--set", "field=gvf", "--set", "field.iterations=200000"]


def leftovers(folder):
    return sorted(path.name for path in pathlib.Path(folder).iterdir())


class Result(CliTest):
    def test_leaves_everything_it_promises(self):
        files = set(hashes(small_result()))
        expected = {"results.json", "results.csv", "options.json", "report.html", "cycle.pvd", "cycle.glb", "manifest.txt"}
        expected |= {f"meshes/{wall}_g0{gate}.{ending}" for wall in ("endo", "epi", "edge_endo", "edge_epi")
                     for gate in (1, 2, 3, 4) for ending in ("ply", "vtp")}
        expected |= {f"measures/{name}" for name in ("segments.csv", "polar.csv", "phase_histogram.svg", "splash.png")}
        expected |= {f"measures/polar_{name}.svg" for name in (
            "perfusion_percent", "thickness_ed_mm", "thickness_es_mm", "thickening_percent", "count_thickening_percent",
            "motion_mm", "phase_counts_deg", "phase_motion_deg", "phase_thickness_deg")}
        self.assertEqual(files, expected)

    def test_tells_the_same_numbers_everywhere(self):
        results = self.read_json(small_result() / "results.json")
        self.assertEqual(results["schema"], "dynasurf.ventricle/3")
        rows = (small_result() / "results.csv").read_text().splitlines()
        self.assertEqual(len(rows), 5)
        for gate, row in zip(results["gates"], rows[1:]):
            endo = gate["endo_ml"]
            measured = json.loads(run("measure", small_result() / f"meshes/endo_g0{gate['gate']}.ply", "--json").stdout)
            self.assertAlmostEqual(measured["volume_ml"], endo, delta=1e-6 * endo)
            cells = dict(zip(rows[0].split(","), row.split(",")))
            self.assertAlmostEqual(float(cells["endo_ml"]), endo, delta=1e-3)
            self.assertAlmostEqual(float(cells["edge_endo_ml"]), gate["edge"]["endo_ml"], delta=1e-3)
            self.assertAlmostEqual(gate["wall_ml"], gate["epi_ml"] - endo, places=9)
        for reading, gates in ((results, results["gates"]), (results["readings"]["edge"],
                                                             [gate["edge"] for gate in results["gates"]])):
            volumes = [gate["endo_ml"] for gate in gates]
            self.assertAlmostEqual(reading["edv_ml"], max(volumes), places=9)
            self.assertAlmostEqual(reading["ef_percent"], 100 * (max(volumes) - min(volumes)) / max(volumes), delta=0.5)

    def test_gives_one_answer_everywhere(self):
        done = run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r")
        results = self.read_json(self.folder / "r" / "results.json")
        leading = results["readings"][results["reading"]]
        self.assertEqual({key: results[key] for key in leading if key in results},
                         {key: leading[key] for key in leading if key in results})
        self.assertIn("EDV %.1f mL" % results["edv_ml"], done.stdout)
        self.assertIn("EF %.1f %%" % results["ef_percent"], done.stdout)
        shown = json.loads(re.search(r'id="data">(.*?)</script>', (self.folder / "r/report.html").read_text(), re.S)[1])
        self.assertEqual(shown["results"]["edv_ml"], results["edv_ml"])

    def test_prints_a_table_and_progress(self):
        done = run("ventricle", small_patient() / "study.nii.gz", "--out", self.folder / "r")
        self.assertEqual(done.returncode, 0, done.stderr)
        for word in ("gate", "endo_ml", "EDV", "EF", "verdict: ", "Research use only"):
            self.assertIn(word, done.stdout)
        self.assertIn("surfaces 8/8\n", done.stderr)
        self.assertNotIn("\x1b", done.stderr)

    def test_reads_psf_corrected_volumes_unless_edges_are_asked_for(self):
        def reading_of(result):
            return self.read_json(result / "results.json")["readings"]

        both = reading_of(small_result())
        self.assertGreater(both["psf_corrected"]["edv_ml"], 1.05 * both["edge"]["edv_ml"], "edges read low")
        low, high = both["psf_corrected"]["edv_ml_90"]
        truth = self.read_json(small_patient() / "truth.json")["edv_ml"]
        self.assertTrue(low < truth < high, (low, truth, high))
        done = run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", *EDGES)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("PSF-corrected", done.stdout)
        self.assertIsNone(reading_of(self.folder / "r")["psf_corrected"])
        self.assertEqual(reading_of(self.folder / "r")["edge"], both["edge"])

    def test_quiet_is_quiet(self):
        done = run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--quiet")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        self.assertTrue((self.folder / "r" / "results.json").exists())

    def test_quiet_leaves_json_its_output(self):
        done = run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--quiet", "--json", *EDGES)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(json.loads(done.stdout), self.read_json(self.folder / "r" / "results.json"))

    def test_writes_the_mesh_formats_asked_for(self):
        run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--mesh-format", "stl,obj,off",
            *EDGES)
        endings = {path.suffix for path in (self.folder / "r" / "meshes").iterdir()}
        self.assertEqual(endings, {".stl", ".obj", ".off"})
        self.assertFalse((self.folder / "r" / "cycle.pvd").exists())

    def test_keeps_the_stages(self):
        run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--keep-stages", *EDGES)
        stages = set(leftovers(self.folder / "r" / "stages"))
        for stage in ("image.nrrd", "edges.nrrd", "labels.nrrd", "border_endo.nrrd", "field_epi.vti", "field_epi.nrrd",
                      "start_endo.ply", "evolved_epi.ply", "settled_endo.ply", "history_epi.csv", "distances_endo.csv"):
            self.assertLessEqual({f"g0{gate}_{stage}" for gate in (1, 2, 3, 4)}, stages)
        self.assertEqual(run("info", self.folder / "r" / "stages" / "g01_image.nrrd").returncode, 0)

        # What the tables say of the particles is what results.json says of them.
        surface = self.read_json(self.folder / "r" / "results.json")["gates"][1]["edge"]["epi"]
        history = (self.folder / "r" / "stages" / "g02_history_epi.csv").read_text().split()
        self.assertEqual(len(history), 1 + surface["steps"])
        counts = [int(n) for n in history[-1].split(",")]
        self.assertEqual(counts[0], surface["steps"])
        self.assertEqual(counts[3] + counts[4], 642)
        rows = [row.split(",") for row in (self.folder / "r" / "stages" / "g02_distances_epi.csv").read_text().split()[1:]]
        self.assertEqual(len(rows), 642)
        within = sum(abs(float(distance)) < 1 for _, distance, _ in rows) / 642
        self.assertAlmostEqual(within, surface["within_one_voxel"], places=9)
        stopped = sum(int(stop) for _, _, stop in rows) / 642
        self.assertAlmostEqual(stopped, surface["stopped_fraction"], places=9)

    def test_keeps_trajectories_and_forces_on_request(self):
        run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--keep-stages",
            "--set", "evolution.trajectory_every=25", *EDGES)
        stages = self.folder / "r" / "stages"
        rows = [row.split(",") for row in (stages / "g01_trajectories_epi.csv").read_text().split()]
        self.assertEqual(rows[0], ["step", "particle", "x_mm", "y_mm", "z_mm", "pull_x_n", "pull_y_n", "pull_z_n"])
        surface = self.read_json(self.folder / "r" / "results.json")["gates"][0]["edge"]["epi"]
        steps = sorted({int(row[0]) for row in rows[1:]})
        self.assertEqual((steps[:2], steps[-1]), ([0, 25], surface["steps"]))
        self.assertEqual(len(rows) - 1, 642 * len(steps))
        # The first step's places are the start mesh's, in its order.
        start = (stages / "g01_start_epi.ply").read_bytes().split(b"end_header\n")[1]
        first = struct.unpack_from("<3d", start)
        for here, there in zip(rows[1][2:5], first):
            self.assertAlmostEqual(float(here), there, places=5)

    def test_keeps_what_other_pipelines_pass_through(self):
        study, result = small_patient() / "study.dcm", self.folder / "r"
        run("ventricle", study, "--out", result, "--keep-stages", "--pipeline", "direct", "--set",
            "evolution.damping=border", *EDGES)
        stages = set(leftovers(result / "stages"))
        self.assertLessEqual({"g01_edge_map_endo.nrrd", "g01_edge_map_epi.nrrd", "g01_drag_epi.nrrd"}, stages)
        shutil.rmtree(result)
        run("ventricle", study, "--out", result, "--keep-stages", "--pipeline", "contour", *EDGES)
        stages = set(leftovers(result / "stages"))
        self.assertNotIn("g01_drag_epi.nrrd", stages)
        rows = (result / "stages" / "g01_contours_epi.csv").read_text().split()[1:]
        slices = {row.split(",")[0] for row in rows}
        self.assertGreater(len(slices), 5)
        # The mesh's own points, within its box.
        heights = [float(row.split(",")[4]) for row in rows]
        mesh = json.loads(run("measure", result / "stages" / "g01_evolved_epi.ply", "--json").stdout)
        self.assertGreater(mesh["vertices"], 100)
        self.assertGreater(max(heights) - min(heights), 30)

    def test_keeps_the_mesh_that_was_deformed(self):
        start = small_patient() / "truth" / "endo_g01.ply"
        run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--keep-stages", "--start", start, *EDGES,
            "--set", "evolution.end.max_steps=2")  # the start matters here, and it has 21,000 triangles
        given, kept = (json.loads(run("measure", mesh, "--json").stdout)
                       for mesh in (start, self.folder / "r" / "stages" / "g02_start_epi.ply"))
        self.assertEqual(kept["vertices"], given["vertices"])

    def test_joins_contours_when_asked(self):
        done = run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--pipeline", "contour",
                   "--keep-stages", "--set", "keyframes.frames_between=2", *EDGES)
        self.assertEqual(done.returncode, 0, done.stderr)
        results = self.read_json(self.folder / "r" / "results.json")
        for gate in results["gates"]:
            for wall in ("endo", "epi"):
                volumes = gate["edge"][wall]["contour_volumes"]
                self.assertAlmostEqual(volumes["gauss_ml"], volumes["triangle_exact_ml"], places=6)
                self.assertAlmostEqual(volumes["trapezoid_ml"], volumes["gauss_ml"], delta=0.05 * volumes["gauss_ml"])
        self.assertIn("surface.no_correspondence", [note["code"] for note in results["notes"]])
        self.assertFalse((self.folder / "r" / "keyframes").exists())
        self.assertFalse((self.folder / "r" / "cycle.glb").exists())
        again = run("rerun", self.folder / "r", "--study", small_patient() / "study.dcm", "--out", self.folder / "again")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertIsNone(self.read_json(small_result() / "results.json")["gates"][0]["edge"]["endo"]["contour_volumes"])
        refused = run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "no", "--pipeline", "cube")
        self.assertEqual(refused.returncode, 1)

    def test_writes_keyframes_when_asked(self):
        run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--mesh-format", "obj", "--set",
            "keyframes.frames_between=2", *EDGES)
        names = leftovers(self.folder / "r" / "keyframes")
        self.assertEqual(len(names), 2 * 4 * 3)
        # Every third frame is a gate; OBJ holds no measures of vertices, which only gates have.
        self.assertEqual((self.folder / "r/keyframes/endo_f04.obj").read_bytes(),
                         (self.folder / "r/meshes/endo_g02.obj").read_bytes())

    def test_a_study_without_a_heart_ends_with_3_and_a_report(self):
        empty_study(self.folder / "empty.nii")
        done = run("ventricle", self.folder / "empty.nii", "--out", self.folder / "r")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("verdict: fail", done.stdout)
        results = self.read_json(self.folder / "r" / "results.json")
        self.assertEqual(results["quality"]["verdict"], "fail")
        self.assertIsNone(results["ef_percent"])
        self.assertTrue((self.folder / "r" / "report.html").is_file())


class LabelMap(CliTest):
    def test_reads_the_muscle_of_a_label_map(self):
        # Muscle 1, blood 2 with sharp borders: without --label the bright blood would be taken for a blood pool.
        scan, out = self.folder / "scan", self.folder / "labels"
        made = run("phantom", "patient", "--out", scan, *SMALL_PATIENT, "--set", "fwhm_mm=0", "--set", "noise.peak_counts=0",
                   "--set", "noise.filter_fwhm_mm=0", "--set", "background=0", "--set", "cavity=2")
        self.assertEqual(made.returncode, 0, made.stderr)
        study = scan / "study.nii.gz"
        nifti = bytearray(gzip.decompress(study.read_bytes()))
        # Of muscle at 1 and blood at 2 the nearest whole number is the label; voxels are doubles or floats as stored.
        kind, start = struct.unpack_from("<h", nifti, 70)[0], int(struct.unpack_from("<f", nifti, 108)[0])
        self.assertEqual(kind, 16, "expected floats")
        values = array.array("f", bytes(nifti[start:]))
        top = max(values)
        values = array.array("f", [float(round(2 * v / top)) for v in values])
        study.write_bytes(gzip.compress(bytes(nifti[:start]) + values.tobytes()))
        made = run("ventricle", study, "--out", out, "--label", 1, "--fwhm", 0)
        self.assertIn(made.returncode, (0, 3), made.stdout + made.stderr)
        fit = self.read_json(out / "results.json")["readings"]["psf_corrected"]
        truth = [gate["endo_ml"] for gate in self.read_json(scan / "truth.json")["gates"]]
        self.assertAlmostEqual(fit["edv_ml"] / max(truth), 1, delta=0.08)
        self.assertEqual(self.read_json(out / "options.json")["label"], 1)
        self.refuses(2, "ventricle", study, "--out", self.folder / "none", "--label", 7, says="no voxel has the label 7")


class SameBytes(CliTest):
    def test_for_any_number_of_threads(self):
        for threads in (1, 2, 4, 8):
            done = run("ventricle", small_patient() / "study.dcm", "--out", self.folder / str(threads), "--threads",
                       threads, "--no-timings", "--keep-stages")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(hashes(self.folder / str(threads)), hashes(self.folder / "1"), f"{threads} threads")

    def test_only_the_times_differ_between_runs(self):
        run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r")
        again, first = hashes(self.folder / "r"), hashes(small_result())
        self.assertEqual({name for name in first if first[name] != again[name]},
                         {"results.json", "manifest.txt"})
        old, new = (self.read_json(folder / "results.json") for folder in (small_result(), self.folder / "r"))
        old.pop("timings_s"), new.pop("timings_s")
        self.assertEqual(old, new)

    def test_a_rerun_finds_the_study_by_its_hash_and_repeats_it(self):
        shutil.copytree(small_result(), self.folder / "result")
        shutil.copy(small_patient() / "study.dcm", self.folder / "another name")
        (self.folder / "junk.txt").write_text("no study")
        done = run("rerun", self.folder / "result", "--out", self.folder / "again", "--threads", 1)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn(f"same bytes: {len(hashes(small_result())) - 1} files", done.stdout)
        self.assertEqual(hashes(self.folder / "again")["report.html"], hashes(small_result())["report.html"])
        self.assertEqual(run("rerun", self.folder / "result").returncode, 0)
        self.assertEqual(leftovers(self.folder), ["again", "another name", "junk.txt", "result"])

    def test_a_rerun_repeats_options_formats_and_stages(self):
        run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--preset", "thesis", "--set",
            "edges.high=0.6", "--mesh-format", "off", "--keep-stages", "--no-timings")
        run("rerun", self.folder / "r", "--study", small_patient() / "study.dcm", "--out", self.folder / "again")
        self.assertEqual(hashes(self.folder / "again"), hashes(self.folder / "r"))

    def test_a_rerun_repeats_the_mesh_that_was_started_from(self):
        start = small_result() / "meshes" / "epi_g01.ply"
        done = run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--start", start, *EDGES)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        again = run("rerun", self.folder / "r", "--study", small_patient() / "study.dcm", "--start", start)
        self.assertEqual(again.returncode, 0, again.stdout + again.stderr)

    def test_a_rerun_tells_what_differs(self):
        shutil.copytree(small_result(), self.folder / "result")
        with open(self.folder / "result" / "results.csv", "a", encoding="utf-8") as table:
            table.write("9,9\n")
        done = run("rerun", self.folder / "result", "--study", small_patient() / "study.dcm")
        self.assertEqual(done.returncode, 3)
        self.assertIn(f"1 of {len(hashes(small_result())) - 1} files differ:\n  results.csv\n", done.stdout)

    def test_a_rerun_refuses_another_study_and_broken_records(self):
        shutil.copytree(small_result(), self.folder / "result")
        self.refuses(2, "rerun", self.folder / "result", says="name it with --study", cwd=self.folder)
        self.refuses(2, "rerun", self.folder / "result", "--study", small_patient() / "study.nii.gz", says="is not the study")
        self.refuses(1, "rerun", self.folder / "result", "--study", small_patient() / "study.dcm", "--out",
                     self.folder / "result", says="holds the input")
        self.refuses(2, "rerun", self.folder, says="results.json")
        for text in ("", "{", "[]", '{"schema": "other"}', '{"schema": "dynasurf.ventricle/3"}'):
            (self.folder / "result" / "results.json").write_text(text)
            self.refuses(2, "rerun", self.folder / "result", says="results.json")

    def test_options_json_of_a_result_is_an_options_file(self):
        run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "a", "--set", "edges.sigma_px=2", "--set",
            "evolution.solver=euler", *EDGES)
        run("ventricle", small_patient() / "study.dcm", "--out", self.folder / "b", "--options",
            self.folder / "a" / "options.json")
        self.assertEqual(hashes(self.folder / "a")["meshes/endo_g01.ply"], hashes(self.folder / "b")["meshes/endo_g01.ply"])
        self.assertNotEqual(hashes(self.folder / "a")["options.json"], hashes(small_result())["options.json"])


class BadDays(CliTest):
    def start(self, *arguments):
        """Starts a slow run and waits until it is at work."""
        process = subprocess.Popen([PROGRAM, "ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", *SLOW,
                                    *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        self.assertTrue(process.stderr.readline())
        return process

    def test_wrong_options_end_with_1_and_one_line_before_any_work(self):
        study, out = small_patient() / "study.dcm", self.folder / "r"
        cases = [
            (["--set", "edges.sgima_px=2"], ["did you mean 'edges.sigma_px'?", "choices: method, sigma_px, low"]),
            (["--set", "edges.sigma_px=21"], ["edges.sigma_px is '21'; expected a number >= 0 and <= 20 (px)"]),
            (["--set", "edges.sigma_px=wide"], ["expected a number"]),
            (["--set", "edges=sobell"], ["option edges is 'sobell'; did you mean 'sobel'? choices: canny"]),
            (["--set", "evolution.solver=rk5"], ["did you mean 'rk4'?", "euler, midpoint, rk4"]),
            (["--set", "edges.low"], ["expected path=value"]),
            (["--preset", "thesys"], ["did you mean 'thesis'?"]),
            (["--mesh-format", "ply,fbx"], ["choices: ply, stl, obj, off, vtp, glb, 3mf"]),
            (["--options", self.folder / "missing.json"], ["missing.json"]),
        ]
        for arguments, says in cases:
            code = 2 if arguments[0] == "--options" else 1
            self.refuses(code, "ventricle", study, "--out", out, *arguments, says=says)
        for text, says in (('{"edgez": {}}', "did you mean 'edges'?"), ('{"mesh_level": 2.5}', "a whole number"),
                           ('{"mesh_level": 3', "options: line 1, column 17: "), ('{"mesh_level": 1, "mesh_level": 2}', '"mesh_level" twice')):
            (self.folder / "o.json").write_text(text)
            self.refuses(1, "ventricle", study, "--out", out, "--options", self.folder / "o.json", says=["o.json: ", says])
        self.assertFalse(out.exists())

    def test_wrong_input_ends_with_2_and_leaves_nothing(self):
        (self.folder / "empty").write_bytes(b"")
        junk = self.folder / "junk"
        junk.mkdir()
        (junk / "notes.txt").write_text("not a heart")
        before = leftovers(self.folder)
        for study in ("missing", "empty", "junk"):
            self.refuses(2, "ventricle", self.folder / study, "--out", self.folder / "r", says=study)
        self.assertEqual(leftovers(self.folder), before)

    def test_a_folder_of_the_user_is_never_replaced(self):
        mine = self.folder / "mine"
        mine.mkdir()
        (mine / "thesis.txt").write_text("years of work")
        self.refuses(2, "ventricle", small_patient() / "study.dcm", "--out", mine, says="mine")
        self.refuses(2, "ventricle", small_patient() / "study.dcm", "--out", mine / "thesis.txt", says="thesis.txt")
        self.refuses(2, "ventricle", small_patient() / "study.dcm", "--out", "/proc/no/such/place", says="/proc")
        self.assertEqual((mine / "thesis.txt").read_text(), "years of work")

    def test_ctrl_c_stops_soon_with_3_and_leaves_nothing(self):
        for sent in (signal.SIGINT, signal.SIGTERM):
            process = self.start()
            process.send_signal(sent)
            asked = time.monotonic()
            _, error = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 3)
            self.assertLess(time.monotonic() - asked, 10)  # measured well below 1 s; the machine may be busy
            self.assertTrue(error.endswith("dynasurf: error: stopped on request; nothing was written\n"), error)
            self.assertEqual(leftovers(self.folder), [])

    def test_ctrl_c_leaves_the_former_result(self):
        shutil.copytree(small_result(), self.folder / "r")
        process = self.start()
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertEqual(hashes(self.folder / "r"), hashes(small_result()))
        self.assertEqual(leftovers(self.folder), ["r"])

    def test_kill_leaves_the_old_result_or_the_new_one(self):
        study, out = small_patient() / "study.dcm", self.folder / "r"
        started = time.monotonic()
        run("ventricle", study, "--out", self.folder / "new", "--no-timings", "--set", "edges.high=0.65", *EDGES)
        whole = time.monotonic() - started
        run("ventricle", study, "--out", out, "--no-timings", *EDGES)
        complete = [hashes(out), hashes(self.folder / "new")]
        for step in range(12):
            process = subprocess.Popen([PROGRAM, "ventricle", study, "--out", out, "--no-timings", "--set",
                                        "edges.high=0.65", *EDGES], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(whole * (step + 1) / 11)
            process.kill()
            process.wait()
            self.assertIn(hashes(out), complete, f"killed after {step + 1}/11 of a run")
        self.assertEqual(run("ventricle", study, "--out", out, "--no-timings", *EDGES).returncode, 0)
        self.assertEqual(leftovers(self.folder), ["new", "r"], "what killed runs left is gone")

    def test_a_limit_of_file_size_ends_with_2_and_leaves_the_former_result(self):
        shutil.copytree(small_result(), self.folder / "r")
        limit = (20000, 20000)
        line = self.refuses(2, "ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", "--quiet",
                            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, limit))
        self.assertIn("too large", line)
        self.assertEqual(hashes(self.folder / "r"), hashes(small_result()))
        self.assertEqual(leftovers(self.folder), ["r"])

    def test_a_full_disk_ends_with_2_and_leaves_nothing(self):
        script = ('mount -t tmpfs -o size=300k tmpfs "$2" || exit 77; '
                  '"$0" ventricle "$1" --out "$2/r" --quiet; code=$?; ls -A "$2"; exit $code')
        done = subprocess.run(["unshare", "-rm", "bash", "-c", script, PROGRAM, small_patient() / "study.dcm", self.folder],
                              capture_output=True, text=True)
        if done.returncode == 77 or "unshare" in done.stderr:
            self.skipTest("a small file system cannot be mounted here")
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
        self.assertIn("No space left on device", done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1)

    def test_a_closed_standard_output_leaves_a_whole_result(self):
        done = subprocess.run(["bash", "-c", '"$0" ventricle "$1" --out "$2" >&-', PROGRAM,
                               small_patient() / "study.dcm", self.folder / "r"], stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("cannot write to standard output", done.stderr)
        self.assertEqual(set(hashes(self.folder / "r")), set(hashes(small_result())))


class Privacy(CliTest):
    CANARIES = {
        (0x0008, 0x0020): ("DA", "20090813"), (0x0008, 0x0021): ("DA", "20090813"), (0x0008, 0x0023): ("DA", "20090813"),
        (0x0008, 0x0050): ("SH", "CANARYACC"), (0x0008, 0x0080): ("LO", "CANARYHOSPITAL"),
        (0x0008, 0x0090): ("PN", "CANARY^DOCTOR"), (0x0008, 0x1010): ("SH", "CANARYSTATION"),
        (0x0008, 0x1030): ("LO", "CANARYSTUDY"), (0x0008, 0x103E): ("LO", "CANARYSERIES"),
        (0x0008, 0x1070): ("PN", "CANARY^OPERATOR"), (0x0010, 0x0010): ("PN", "CANARY^NAME"),
        (0x0010, 0x0020): ("LO", "CANARYID42"), (0x0010, 0x0030): ("DA", "19420317"),
        (0x0010, 0x4000): ("LT", "CANARYCOMMENT"),
    }

    def study(self):
        folder = self.folder / "CANARYPATH"
        folder.mkdir()
        study = folder / "CANARYFILE.dcm"
        study.write_bytes(with_elements((small_patient() / "study.dcm").read_bytes(), self.CANARIES))
        return study

    def assert_clean(self, data, where):
        for canary in (b"canary", b"19420317", b"1942-03-17", b"20090813", b"2009-08-13"):
            self.assertNotIn(canary, data.lower(), where)

    def test_no_personal_data_reach_any_output(self):
        study = self.study()
        done = run("ventricle", study, "--out", self.folder / "r", "--keep-stages")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_clean((done.stdout + done.stderr).encode(), "terminal")
        for path in sorted((self.folder / "r").rglob("*")):
            self.assert_clean(str(path.relative_to(self.folder)).encode(), path.name)
            if path.is_file():
                self.assert_clean(path.read_bytes(), path.name)

    def test_info_shows_no_personal_data(self):
        study = self.study()
        for arguments in ([], ["--json"]):
            done = run("info", study, *arguments)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assert_clean(done.stdout.encode(), "info")

    def test_the_name_of_the_file_is_recorded_only_when_asked(self):
        run("ventricle", self.study(), "--out", self.folder / "r", "--with-phi", *EDGES)
        inputs = self.read_json(self.folder / "r" / "results.json")["provenance"]["inputs"]
        self.assertEqual([entry["file"] for entry in inputs], ["CANARYFILE.dcm"])

    def test_memory_never_reaches_a_core_file(self):
        process = subprocess.Popen([PROGRAM, "ventricle", small_patient() / "study.dcm", "--out", self.folder / "r", *SLOW],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        with process:
            process.stderr.readline()
            limits = pathlib.Path(f"/proc/{process.pid}/limits").read_text()
            process.kill()
        self.assertRegex(limits, r"Max core file size +0 +0")


if __name__ == "__main__":
    unittest.main()
