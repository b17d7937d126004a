"""Many studies: a row for every one, the same bytes as one by one, nothing lost to kills, nothing done twice."""

import csv
import functools
import os
import pathlib
import random
import shutil
import signal
import subprocess
import time
import unittest

from cli import PROGRAM, CliTest, hashes, run, shared_folder

# Quick runs: the edges alone, of patients of two gates.
QUICK = ["--set", "fit.run=false"]
PATIENTS = ["--small", "--seed", 4, "--set", "gates=2", "--set", "irregular.walls=0"]
STUDIES = 6


@functools.cache
def patients():
    folder = shared_folder() / "patients"
    made = run("phantom", "patients", "--count", STUDIES // 2, "--repeats", 2, "--out", folder, "--quiet", *PATIENTS)
    assert made.returncode == 0, made.stderr
    return folder


@functools.cache
def serial():
    """What each study gives by itself."""
    folder = shared_folder() / "serial"
    for row in rows_of(patients() / "patients.tsv"):
        done = run("ventricle", patients() / row["path"], "--out", folder / row["id"], "--quiet", "--no-timings", *QUICK)
        assert done.returncode in (0, 3), done.stderr
    return {row["id"]: hashes(folder / row["id"]) for row in rows_of(patients() / "patients.tsv")}


def rows_of(table):
    with open(table, newline="") as file:
        return list(csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE))


def status_of(cohort):
    """The last row of every study."""
    return {row["id"]: row for row in rows_of(cohort / "status.tsv")}


def result_of(cohort, name):
    return next((cohort / "studies").glob(f"*/{name}"))


class BatchTest(CliTest):
    def batch(self, *words, **more):
        more.setdefault("timeout", 500)
        return run("batch", *words, **more)

    def table(self, rows, name="studies.tsv"):
        """A table of studies: id and path."""
        path = self.folder / name
        path.write_text("id\tpath\n" + "".join(f"{key}\t{value}\n" for key, value in rows.items()))
        return path

    def equals_serial(self, cohort, ids=None):
        for name in ids or serial():
            self.assertEqual(hashes(result_of(cohort, name)), serial()[name], name)


class Batch(BatchTest):
    def test_gives_the_bytes_of_single_runs_and_goes_on_where_it_ended(self):
        cohort = self.folder / "cohort"
        done = self.batch(patients() / "patients.tsv", "--out", cohort, "--jobs", 2, "--", *QUICK)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"{STUDIES} of {STUDIES} studies done", done.stdout)
        self.equals_serial(cohort)
        before = (cohort / "status.tsv").read_bytes()
        again = self.batch(patients() / "patients.tsv", "--out", cohort, "--", *QUICK)
        self.assertIn(", 0 run now", again.stdout)
        self.assertEqual((cohort / "status.tsv").read_bytes(), before)

    def test_tells_what_changed_and_runs_it_when_asked(self):
        cohort = self.folder / "cohort"
        one = patients() / rows_of(patients() / "patients.tsv")[0]["path"]
        study = self.folder / "study.dcm"
        shutil.copy(one, study)
        table = self.table({"a": study})
        words = [table, "--out", cohort, "--no-collect"]
        self.batch(*words, "--", *QUICK)
        os.utime(study)  # another time, the same content
        self.assertNotIn("changed", self.batch(*words, "--", *QUICK).stdout)
        other = self.batch(*words, "--", *QUICK, "--set", "measures.waves=2")
        self.assertIn("changed: 1", other.stdout)
        self.assertIn(", 0 run now", other.stdout)
        self.assertIn(", 1 run now", self.batch(*words, "--again", "changed", "--", *QUICK, "--set", "measures.waves=2").stdout)
        shutil.copy(patients() / rows_of(patients() / "patients.tsv")[2]["path"], study)
        self.assertIn("changed: 1", self.batch(*words, "--", *QUICK, "--set", "measures.waves=2").stdout)

    def test_shards_share_the_list(self):
        cohort = self.folder / "cohort"
        for shard in ("1/3", "2/3", "3/3"):
            done = self.batch(patients() / "patients.tsv", "--out", cohort, "--shard", shard, "--", *QUICK)
            self.assertIn(f"{STUDIES // 3} of {STUDIES // 3} studies done", done.stdout, done.stderr)
        self.assertEqual(len(rows_of(cohort / "status.tsv")), STUDIES)
        self.equals_serial(cohort)

    def test_refuses_what_it_does_not_understand(self):
        table = patients() / "patients.tsv"
        out = self.folder / "cohort"
        self.refuses(1, "batch", table, "--out", out, "--shard", "4/3", says="--shard is 4/3; expected I/N")
        self.refuses(1, "batch", table, "--out", out, "--shard", "x", says="expected I/N")
        self.refuses(1, "batch", table, "--out", out, "--", "--out", "x", says="--out behind --")
        self.refuses(1, "batch", table, "--out", out, "--quiet", "--", "--set", "fit.runs=1", says="did you mean 'fit.run'")
        self.refuses(2, "batch", self.folder, "--out", out, says="holds no gated heart study")
        self.refuses(2, "batch", self.folder / "none.tsv", "--out", out, says="none.tsv")

    def test_stops_at_once_and_goes_on(self):
        cohort = self.folder / "cohort"
        words = [PROGRAM, "batch", str(patients() / "patients.tsv"), "--out", str(cohort), "--jobs", "1", "--", *QUICK]
        child = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        wait_until(lambda: (cohort / "status.tsv").exists() and len(rows_of(cohort / "status.tsv")) >= 1)
        begin = time.monotonic()
        child.send_signal(signal.SIGINT)
        out, err = child.communicate(timeout=30)
        self.assertLess(time.monotonic() - begin, 5)
        self.assertEqual(child.returncode, 3)
        self.assertIn("stopped on request; ", err)
        self.assertEqual(list(cohort.rglob("*.partial-*")), [])
        self.batch(patients() / "patients.tsv", "--out", cohort, "--", *QUICK)
        self.equals_serial(cohort)


def wait_until(holds, seconds=120):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if holds():
            return
        time.sleep(0.02)
    raise AssertionError("it did not come to it")


class Spoiled(BatchTest):
    def spoiled(self):
        """Two good studies, and one of every kind that goes wrong."""
        good = [patients() / row["path"] for row in rows_of(patients() / "patients.tsv")[:2]]
        cut, empty, nothing = (self.folder / name for name in ("cut.dcm", "empty.dcm", "text.dcm"))
        cut.write_bytes(good[0].read_bytes()[:20000])
        empty.write_bytes(b"")
        nothing.write_text("no study at all\n")
        self.assertEqual(run("phantom", "organ", "--out", self.folder / "organ", "--quiet").returncode, 0)
        not_a_number = self.folder / "nan.nii"
        not_a_number.write_bytes(nan_study())
        names = [row["id"] for row in rows_of(patients() / "patients.tsv")[:2]]
        return {names[0]: good[0], "cut": cut, "empty": empty, "text": nothing, "missing": self.folder / "missing.dcm",
                "nan": not_a_number, "hangs": good[0], "takes-memory": good[0], "crashes": good[0], "is-killed": good[0],
                "not-a-heart": self.folder / "organ" / "study.dcm", names[1]: good[1]}, names

    def test_studies_have_a_row_with_their_reason_and_cost_no_other(self):
        studies, good = self.spoiled()
        cohort = self.folder / "cohort"
        faults = "hangs=hang,takes-memory=memory,crashes=crash,is-killed=kill"
        done = self.batch(self.table(studies), "--out", cohort, "--jobs", 3, "--time-limit", 25, "--memory-limit", "700M", "--", *QUICK,
                          env={**os.environ, "DYNASURF_DEBUG_FAULTS": faults})
        self.assertEqual(done.returncode, 3, done.stderr)
        status = status_of(cohort)
        self.assertEqual(set(status), set(studies))
        for name, says in {"cut": "cut", "empty": "is empty", "text": "not a heart study", "missing": "cannot open",
                           "nan": "voxel (0,0,0) of gate 1", "hangs": "time limit of 25 s", "takes-memory": "the limit is 700 MiB",
                           "crashes": "crashed, signal 11", "is-killed": "killed from outside, signal 9"}.items():
            self.assertEqual(status[name]["state"], "failed", name)
            self.assertIn(says, status[name]["reason"], name)
            self.assertNotIn(str(self.folder), status[name]["reason"], name)
        self.assertEqual(status["is-killed"]["attempts"], "2")
        self.assertEqual(status["crashes"]["attempts"], "1")
        self.assertIn(status["not-a-heart"]["verdict"], ("check", "fail"))
        for name in good:
            self.assertEqual(status[name]["state"], "done", f"{name}: {status[name]['reason']}")
        self.equals_serial(cohort, good)
        self.assertEqual(list(cohort.rglob("*.partial-*")), [])
        table = {row["id"]: row for row in rows_of(cohort / "tables" / "studies.tsv")}
        self.assertEqual(set(table), set(studies))
        self.assertEqual(table["cut"]["reason"], status["cut"]["reason"])
        # What went wrong by chance comes right when it is asked for again.
        again = self.batch(self.table(studies), "--out", cohort, "--again", "failed", "--time-limit", 120, "--", *QUICK)
        for name in ("hangs", "takes-memory", "crashes", "is-killed"):
            self.assertEqual(status_of(cohort)[name]["state"], "done", again.stderr)
            self.assertEqual(hashes(result_of(cohort, name)), serial()[good[0]], name)


def nan_study():
    """A gated NIfTI study all of whose voxels are no numbers."""
    import struct
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 4, 16, 16, 8, 4, 1, 1, 1)
    struct.pack_into("<2h", header, 70, 16, 32)
    struct.pack_into("<8f", header, 76, 1, 4, 4, 4, 100, 1, 1, 1)
    struct.pack_into("<f", header, 108, 352)
    header[123] = 2 | 16
    struct.pack_into("<h", header, 254, 1)
    for row in range(3):
        struct.pack_into("<4f", header, 280 + 16 * row, *(4.0 if n == row else 0.0 for n in range(4)))
    header[344:348] = b"n+1\0"
    return bytes(header) + struct.pack("<f", float("nan")) * (16 * 16 * 8 * 4)


class Workers(BatchTest):
    def start(self, cohort, table, *words):
        return subprocess.Popen([PROGRAM, "batch", str(table), "--out", str(cohort), "--quiet", "--no-collect", "--jobs", "2", *words, "--", *QUICK],
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def test_of_one_cohort_never_do_a_study_twice(self):
        cohort = self.folder / "cohort"
        workers = [self.start(cohort, patients() / "patients.tsv") for _ in range(3)]
        for worker in workers:
            self.assertEqual(worker.wait(timeout=300), 0, worker.stderr.read())
            worker.stderr.close()
        names = [row["id"] for row in rows_of(cohort / "status.tsv")]
        self.assertEqual(len(names), len(set(names)))
        self.assertEqual(set(names), set(serial()))
        self.equals_serial(cohort)

    def test_that_are_killed_lose_nothing(self):
        cohort, chance = self.folder / "cohort", random.Random(7)
        kills = int(os.environ.get("DYNASURF_KILLS", "25"))
        for _ in range(kills):
            worker = self.start(cohort, patients() / "patients.tsv")
            time.sleep(chance.uniform(0.02, 1.5))
            worker.kill()
            worker.wait()
            worker.stderr.close()
            if (cohort / "status.tsv").exists():
                for row in rows_of(cohort / "status.tsv"):
                    if None not in row.values():  # an unfinished last line
                        self.assertEqual(row["state"], "done", row)
                        self.assertTrue((result_of(cohort, row["id"]) / "results.json").is_file())
        last = self.start(cohort, patients() / "patients.tsv")
        self.assertEqual(last.wait(timeout=300), 0, last.stderr.read())
        last.stderr.close()
        self.assertEqual({row["state"] for row in status_of(cohort).values()}, {"done"})
        self.equals_serial(cohort)
        self.assertEqual([p for p in cohort.rglob("*.partial-*")], [])


class Search(BatchTest):
    def test_finds_the_gated_studies_of_a_tree_and_says_what_it_left_out(self):
        tree = self.folder / "clinic"
        for n, row in enumerate(rows_of(patients() / "patients.tsv")[:2]):
            (tree / f"DOE^JANE {n}").mkdir(parents=True)
            shutil.copy(patients() / row["path"], tree / f"DOE^JANE {n}" / "IM0001")
        made = run("phantom", "camera", "--out", self.folder / "camera", "--quiet", "--set", "heart.gates=2",
                   "--set", "acquisition.views=16", "--set", "reconstruction=fbp")
        self.assertEqual(made.returncode, 0, made.stderr)
        for name in ("projections", "transaxial"):
            shutil.copy(self.folder / "camera" / f"{name}.dcm", tree / name)
        self.assertEqual(run("phantom", "patient", "--out", self.folder / "static", "--quiet", "--set", "gates=1").returncode, 0)
        shutil.copy(self.folder / "static" / "study.dcm", tree / "static")
        (tree / "letter.txt").write_text("no image\n")
        (tree / "DOE^JANE 1" / "damaged").write_bytes((tree / "DOE^JANE 0" / "IM0001").read_bytes()[:5000])
        cohort = self.folder / "cohort"
        done = self.batch(tree, "--out", cohort, "--", *QUICK)
        self.assertEqual(done.returncode, 3, done.stderr)
        found = rows_of(cohort / "inputs.tsv")
        self.assertEqual(sorted(pathlib.Path(row["path"]).name for row in found), ["IM0001", "IM0001", "damaged"])
        left_out = {row["path"]: row["reason"] for row in rows_of(cohort / "left_out.tsv")}
        self.assertIn("ungated", left_out["static"])
        self.assertEqual(left_out["letter.txt"], "no DICOM, NIfTI or NRRD file")
        self.assertIn("projections", left_out["projections"])
        self.assertIn("transaxial", left_out["transaxial"])
        by_path = {pathlib.Path(row["path"]).name: row["id"] for row in found}
        self.assertEqual(status_of(cohort)[by_path["damaged"]]["state"], "failed")
        # Names of files may name a person: they stand in the table of inputs alone.
        for path in cohort.rglob("*"):
            if path.is_file() and path.name != "inputs.tsv" and path.suffix not in (".sqlite", ".glb"):
                self.assertNotIn(b"DOE^JANE", path.read_bytes(), path)


class Clouds(BatchTest):
    def setUp(self):
        super().setUp()
        self.scans = self.folder / "scans"
        (self.scans / "second").mkdir(parents=True)
        for shape, place in (("vase", "vase.ply"), ("sphere", "second/SPHERE.PLY")):
            made = run("phantom", "cloud", "--out", self.folder / shape, "--quiet", "--set", f"shape={shape}", "--set", "points=3000")
            self.assertEqual(made.returncode, 0, made.stderr)
            shutil.copy(self.folder / shape / "cloud.ply", self.scans / place)
        (self.scans / "bad.xyz").write_text("no points\n")
        (self.scans / "bad.PCD").write_text("no points\n")
        (self.scans / "letter.txt").write_text("no points either\n")
        (self.scans / "photo.jpg").write_bytes(b"\xff\xd8")

    def test_a_folder_of_clouds_becomes_a_cohort(self):
        cohort = self.folder / "cohort"
        done = self.batch(self.scans, "--out", cohort, "--command", "cloud", "--", "--triangles", "320")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("4 studies found, 2 files left out", done.stdout)
        self.assertEqual([row["path"] for row in rows_of(cohort / "left_out.tsv")], ["letter.txt", "photo.jpg"])
        by_name = {pathlib.Path(row["path"]).name: row["id"] for row in rows_of(cohort / "inputs.tsv")}
        self.assertEqual(sorted(by_name), ["SPHERE.PLY", "bad.PCD", "bad.xyz", "vase.ply"])
        self.assertTrue(status_of(cohort)[by_name["bad.xyz"]]["reason"].startswith("line 1"))
        rows = {row["id"]: row for row in rows_of(cohort / "tables" / "studies.tsv")}
        for name in ("SPHERE.PLY", "vase.ply"):
            path = next(p for p in (self.scans / name, self.scans / "second" / name) if p.exists())
            alone = self.folder / f"alone-{name}"
            self.assertEqual(run("cloud", path, "--out", alone, "--quiet", "--no-timings", "--triangles", "320").returncode, 0)
            theirs, ours = (self.read_json(f / "results.json") for f in (result_of(cohort, by_name[name]), alone))
            self.assertEqual(theirs["levels"], ours["levels"])
            self.assertEqual((rows[by_name[name]]["state"], rows[by_name[name]]["watertight"]), ("done", "1"))
        again = self.batch(self.scans, "--out", cohort, "--command", "cloud", "--", "--triangles", "320")
        self.assertIn("0 run now", again.stdout)

    def test_a_cloud_to_be_checked_is_told_as_such(self):
        steep = self.folder / "steep"
        self.assertEqual(run("phantom", "terrain", "--out", self.folder / "t", "--quiet").returncode, 0)
        steep.mkdir()
        shutil.copy(self.folder / "t" / "terrain.ply", steep)
        cohort = self.folder / "terrains"
        self.batch(steep, "--out", cohort, "--command", "cloud", "--", "--triangles", "320")
        (row,) = status_of(cohort).values()
        self.assertEqual(row["verdict"], self.read_json(result_of(cohort, row["id"]) / "results.json")["verdict"])
        self.assertEqual(row["verdict"], "check")

    def test_a_folder_without_clouds_is_told(self):
        empty = self.folder / "empty"
        empty.mkdir()
        done = self.batch(empty, "--out", self.folder / "none", "--command", "cloud")
        self.assertEqual((done.returncode, "holds no cloud; expected files" in done.stderr), (2, True), done.stderr)


class Patients(BatchTest):
    def test_are_the_same_again_and_kept(self):
        again = self.folder / "again"
        words = ["phantom", "patients", "--count", 2, "--repeats", 2, "--out", again, "--quiet", *PATIENTS]
        self.assertEqual(run(*words).returncode, 0)
        first = {name: digest for name, digest in hashes(patients()).items() if name in hashes(again) and name != "patients.tsv"}
        self.assertEqual(len(first), 12)  # study, truth and manifest of four studies
        self.assertEqual({name: digest for name, digest in hashes(again).items() if name != "patients.tsv"}, first)
        study = next(again.rglob("study.dcm"))
        before = study.stat().st_mtime_ns
        words[3] = 3
        self.assertEqual(run(*words).returncode, 0)
        self.assertEqual(study.stat().st_mtime_ns, before)
        self.assertEqual(len(rows_of(again / "patients.tsv")), 6)

    def test_refuse_a_folder_of_others(self):
        self.refuses(2, "phantom", "patients", "--count", 1, "--repeats", 2, "--out", patients(), "--seed", 9, "--small", says="other options")
        self.refuses(1, "phantom", "patients", "--out", self.folder / "p", says="--count")
        self.refuses(1, "phantom", "patient", "--count", 2, "--out", self.folder / "p", says="belong to phantom patients")


class Bids(BatchTest):
    def test_runs_participants_and_the_group(self):
        dataset, out = self.folder / "bids", self.folder / "derivatives"
        rows = rows_of(patients() / "patients.tsv")[:2]
        for n, (row, place) in enumerate(zip(rows, ("sub-01/ses-rest/nm/sub-01_ses-rest", "sub-02/nm/sub-02"))):
            (dataset / place).parent.mkdir(parents=True)
            shutil.copy(patients() / row["path"], dataset / f"{place}_nm.dcm")
        (dataset / "participants.tsv").write_text("participant_id\tsex\nsub-01\tF\nsub-02\tn/a\n")
        one = run("bids", dataset, out, "participant", "--participant-label", "02", "--", *QUICK, timeout=300)
        self.assertEqual(one.returncode, 0, one.stderr)
        self.assertEqual([path.name for path in out.glob("sub-*")], ["sub-02"])
        self.assertEqual(run("bids", dataset, out, "participant", "--", *QUICK, timeout=300).returncode, 0)
        stem = out / "sub-01" / "ses-rest" / "nm" / "sub-01_ses-rest_desc-dynasurf"
        sidecar = self.read_json(f"{stem}_report.json")
        self.assertEqual(hashes(out / sidecar["ResultFolder"]), serial()[rows[0]["id"]])
        self.assertTrue(pathlib.Path(f"{stem}_report.html").is_file())
        description = self.read_json(out / "dataset_description.json")
        self.assertEqual((description["DatasetType"], description["GeneratedBy"][0]["Name"]), ("derivative", "dynasurf"))
        group = run("bids", dataset, out, "group")
        self.assertEqual(group.returncode, 0, group.stderr)
        table = rows_of(out / "cohort" / "tables" / "studies.tsv")
        self.assertEqual([(row["participant_id"], row["sex"]) for row in table], [("sub-01", "F"), ("sub-02", "")])
        self.refuses(2, "bids", self.folder, out, "participant", says="expected a BIDS dataset")
        self.refuses(1, "bids", dataset, out, "participant", "--participant-label", "03", says="no study of these participants")


if __name__ == "__main__":
    unittest.main()
