"""What stands at --out: only untouched results are replaced, nothing of the user's is taken, nothing is half written."""

import os
import shutil
import subprocess
import time
import unittest

from cli import EDGES, PROGRAM, CliTest, hashes, run, small_patient, small_result

SPHERE = ["phantom", "sphere", "--quiet"]


def names_beside(place):
    return sorted(path.name for path in place.parent.iterdir())


class Out(CliTest):
    def setUp(self):
        super().setUp()
        self.place = self.folder / "place"
        self.place.mkdir()
        self.out = self.place / "out"
        self.scan = self.folder / "scan"
        made = run("phantom", "cloud", "--out", self.scan, "--set", "shape=sphere", "--set", "points=2000")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.levels = self.folder / "levels"
        made = run("cloud", self.scan / "cloud.ply", "--out", self.levels, "--triangles", "320,80", "--quiet")
        self.assertEqual(made.returncode, 0, made.stderr)

    def commands(self):
        """Every command that writes a folder, without its --out."""
        study = small_patient() / "study.dcm"
        return {
            "ventricle": ["ventricle", study, "--quiet", *EDGES],
            "cloud": ["cloud", self.scan / "cloud.ply", "--quiet", "--triangles", "80"],
            "phantom": SPHERE,
            "phantom cloud": ["phantom", "cloud", "--quiet", "--set", "points=500"],
            "lod": ["lod", self.levels],
            "compare": ["perfusion", "compare", small_result(), small_result()],
            "edges": ["borders", "--edges-only", study, "--quiet"],
            "borders": ["borders", study, "--quiet"],
            "rerun": ["rerun", self.levels, "--quiet", "--input", self.scan / "cloud.ply"],
        }

    def test_every_command_lists_what_it_wrote_and_replaces_it(self):
        for name, command in self.commands().items():
            with self.subTest(name):
                out = self.place / name
                for _ in range(2):
                    done = run(*command, "--out", out)
                    self.assertEqual(done.returncode, 0, done.stderr)
                lines = (out / "manifest.txt").read_text().splitlines()
                listed = {line.split(" ", 2)[2]: line.split(" ", 2)[0] for line in lines[1:]}
                found = hashes(out)
                found.pop("manifest.txt")
                self.assertEqual(listed, found)
        self.assertEqual(names_beside(self.place / "x"), sorted(self.commands()))

    def test_every_command_keeps_a_folder_that_looks_like_a_result(self):
        mine = {"results.json": '{"my": "own"}', "truth.json": "{}", "lod.json": "{}", "comparison.json": "{}",
                "g01_edges.png": "x", "matrix.png": "x", "thesis.tex": "years of work"}
        self.out.mkdir()
        for name, text in mine.items():
            (self.out / name).write_text(text)
        before = hashes(self.out)
        for name, command in self.commands().items():
            with self.subTest(name):
                self.refuses(2, *command, "--out", self.out, says=["out: is kept, for comparison.json", "--replace"])
                self.assertEqual(hashes(self.out), before)
                self.assertEqual(names_beside(self.out), ["out"])

    def test_keeps_a_former_result_that_holds_a_note(self):
        self.assertEqual(run(*SPHERE, "--out", self.out).returncode, 0)
        (self.out / "notes.txt").write_text("seen by me")
        before = hashes(self.out)
        self.refuses(2, *SPHERE, "--out", self.out, says="for notes.txt in it is not listed in its manifest.txt")
        self.assertEqual(hashes(self.out), before)

    def test_keeps_a_former_result_that_was_edited(self):
        self.assertEqual(run(*SPHERE, "--out", self.out).returncode, 0)
        (self.out / "truth.json").write_text((self.out / "truth.json").read_text().replace("sphere", "SPHERE"))
        self.refuses(2, *SPHERE, "--out", self.out, says="for truth.json in it was changed since it was written")

    def test_moves_aside_whatever_it_is_told_to(self):
        for name, command in self.commands().items():
            with self.subTest(name):
                shutil.rmtree(self.place)
                self.out.mkdir(parents=True)
                (self.out / "thesis.tex").write_text("years of work")
                done = run(*command, "--out", self.out, "--replace")
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual((self.place / "out.old-1" / "thesis.tex").read_text(), "years of work")
                self.assertEqual(names_beside(self.out), ["out", "out.old-1"])
                if "--quiet" not in command:
                    self.assertIn("moved aside: " + str(self.place / "out.old-1"), done.stdout)

    def test_no_input_lies_in_the_folder_of_the_result(self):
        study = self.out / "studies" / "study.dcm"
        study.parent.mkdir(parents=True)
        shutil.copy(small_patient() / "study.dcm", study)
        scan = self.out / "cloud.ply"
        shutil.copy(self.scan / "cloud.ply", scan)
        link = self.folder / "link"
        link.symlink_to(self.out)
        for out in (self.out, link, self.out / "studies" / ".."):
            for replace in ([], ["--replace"]):
                self.refuses(1, "ventricle", study, "--out", out, *EDGES, *replace, says="holds the input")
                self.refuses(1, "cloud", scan, "--out", out, *replace, says="holds the input")
                self.refuses(1, "borders", "--edges-only", study, "--out", out, *replace, says="holds the input")
        for command in (["lod", self.levels], ["rerun", self.levels, "--input", self.scan / "cloud.ply"]):
            self.refuses(1, *command, "--out", self.levels, says="holds the input")
        self.refuses(1, "perfusion", "compare", small_result(), small_result(), "--out", small_result(), says="holds the input")
        options = self.out / "options.json"
        options.write_text("{}")
        self.refuses(1, "ventricle", small_patient() / "study.dcm", "--out", self.out, "--options", options,
                     says="holds the input")
        self.refuses(1, "cloud", "cloud.ply", "--out", ".", says="holds the input", cwd=self.out)
        self.assertTrue(study.is_file() and scan.is_file())

    def test_takes_nothing_that_appears_while_it_runs(self):
        """The program is stopped before it ends; something appears; it goes on."""
        for appear in (lambda: (self.out.mkdir(), (self.out / "precious.txt").write_text("mine")),
                       lambda: self.out.write_text("mine")):
            shutil.rmtree(self.place)
            self.place.mkdir()
            process = subprocess.Popen([PROGRAM, *map(str, self.commands()["ventricle"]), "--out", self.out],
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            while not any(path.name.startswith(".out.partial-") for path in self.place.iterdir()):
                time.sleep(0.001)
            appear()
            _, errors = process.communicate(timeout=120)
            self.assertEqual(process.returncode, 2, errors)
            kept = self.out / "precious.txt" if self.out.is_dir() else self.out
            self.assertEqual(kept.read_text(), "mine")
            self.assertEqual(names_beside(self.out), ["out"])

    def test_writes_no_single_file_over_another(self):
        solid = ["solid", small_result()]
        thesis = self.place / "wall.vtu"
        thesis.write_text("years of work")
        self.refuses(2, *solid, "--out", thesis, says=["wall.vtu: exists", "--replace"])
        self.refuses(2, "perfusion", "score", small_result(), "--out", thesis, says="wall.vtu: exists")
        self.assertEqual(thesis.read_text(), "years of work")
        done = run(*solid, "--out", thesis, "--replace")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((self.place / "wall.vtu.old-1").read_text(), "years of work")
        self.assertIn(b"<VTKFile", thesis.read_bytes()[:200])

    def test_takes_away_the_folders_it_made_when_it_fails(self):
        self.refuses(2, "ventricle", self.folder / "missing.dcm", "--out", self.place / "a" / "b" / "c")
        self.assertEqual(list(self.place.iterdir()), [])

    def test_repeats_a_result_and_tells_what_was_changed_in_it(self):
        done = run("rerun", self.levels, "--input", self.scan / "cloud.ply")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        (self.levels / "notes.txt").write_text("mine")
        done = run("rerun", self.levels, "--input", self.scan / "cloud.ply")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("notes.txt in it is not listed", done.stdout)
        mesh = self.levels / "meshes" / "level1.ply"
        mesh.write_bytes(mesh.read_bytes()[:-1] + b"x")
        done = run("rerun", self.levels, "--input", self.scan / "cloud.ply")
        self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
        self.assertIn("meshes/level1.ply", done.stdout)
        self.assertEqual(names_beside(self.levels), ["levels", "place", "scan"])

    def test_looks_for_inputs_without_reading_what_is_too_large(self):
        beside = self.folder / "huge.bin"
        with open(beside, "wb") as file:
            os.truncate(file.fileno(), 1 << 40)  # sparse
        shutil.copy(self.scan / "cloud.ply", self.folder / "cloud.ply")
        begin = time.monotonic()
        self.assertEqual(run("rerun", self.levels).returncode, 0)
        self.assertLess(time.monotonic() - begin, 60)


class Containers(CliTest):
    """Every container counts its processes from one: process numbers say nothing there."""

    UNSHARE = ["unshare", "--pid", "--fork", "--kill-child"]

    def setUp(self):
        super().setUp()
        if shutil.which("unshare") is None or subprocess.run([*self.UNSHARE, "true"], capture_output=True).returncode:
            self.skipTest("this user may not make process name spaces")
        self.place = self.folder / "place"
        self.place.mkdir()
        self.out = self.place / "out"

    def start(self, *command):
        return subprocess.Popen([*self.UNSHARE, PROGRAM, *map(str, command), "--out", self.out],
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True)

    def test_a_killed_first_process_blocks_no_later_one(self):
        command = ["ventricle", small_patient() / "study.dcm", "--quiet", *EDGES]
        for _ in range(3):
            process = self.start(*command)
            while not any(path.name.startswith(".out.partial-") for path in self.place.iterdir()):
                time.sleep(0.001)
            process.kill()  # takes process 1 of the name space along
            process.communicate()
        process = self.start(*command)
        _, errors = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 0, errors)
        self.assertEqual(names_beside(self.out), ["out"])

    def test_runs_with_one_process_number_do_not_tear_one_result(self):
        wholes = []
        for points in (800, 900):
            run("phantom", "cloud", "--quiet", "--set", f"points={points}", "--out", self.folder / str(points))
            wholes.append(hashes(self.folder / str(points)))
        for _ in range(3):
            processes = [self.start("phantom", "cloud", "--quiet", "--set", f"points={points}")
                         for points in (800, 900) * 4]
            for process in processes:
                _, errors = process.communicate(timeout=120)
                self.assertEqual(process.returncode, 0, errors)
            self.assertIn(hashes(self.out), wholes)
            self.assertEqual(names_beside(self.out), ["out"])


if __name__ == "__main__":
    unittest.main()
