"""No name of a folder or file and no date of a study reaches a result of any command, unless names are asked for."""

import functools
import shutil
import unittest

import test_ventricle
from cli import EDGES, CliTest, hashes, run, shared_folder, small_patient

CANARIES = (b"canary", b"19420317", b"1942-03-17", b"20090813", b"2009-08-13", b"101112")


@functools.cache
def study():
    """A study of a patient whose elements, folder and file are all canaries."""
    folder = shared_folder() / "CANARY^STUDY"
    folder.mkdir()
    elements = test_ventricle.Privacy.CANARIES | {(0x0008, 0x0030): ("TM", "101112")}
    path = folder / "CANARY_19420317.dcm"
    path.write_bytes(test_ventricle.with_elements((small_patient() / "study.dcm").read_bytes(), elements))
    return path


@functools.cache
def result():
    """A result of it, in a folder that a person named."""
    folder = shared_folder() / "normals" / "CANARY_HANS_1"
    made = run("ventricle", study(), "--out", folder)
    assert made.returncode == 0, made.stderr
    return folder


@functools.cache
def scans():
    folder = shared_folder() / "CANARY-scans"
    made = run("phantom", "cloud", "--seed", 3, "--out", shared_folder() / "scan", "--set", "shape=ellipsoid",
               "--set", "points=3000")
    assert made.returncode == 0, made.stderr
    folder.mkdir()
    shutil.copy(shared_folder() / "scan" / "cloud.ply", folder / "CANARY.ply")
    return folder / "CANARY.ply"


class Privacy(CliTest):
    def assert_clean(self, data, where):
        for canary in CANARIES:
            self.assertNotIn(canary, data.lower(), where)

    def clean(self, *arguments, out="out"):
        """Runs the command; what it prints and writes is clean. Returns what it wrote."""
        where = self.folder / (out or "nothing")
        done = run(*arguments, *(["--out", where] if out else []))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assert_clean((done.stdout + done.stderr).encode(), f"what {arguments[0]} prints")
        for path in [where, *sorted(where.rglob("*"))] if out else []:
            self.assert_clean(str(path.relative_to(self.folder)).encode(), path.name)
            if path.is_file():
                self.assert_clean(path.read_bytes(), f"{arguments[0]}: {path.name}")
        return where

    def test_a_study_told_in_dicom_tells_its_date_there_alone(self):
        out = self.folder / "r"
        made = run("ventricle", study(), "--out", out, "--dicom", "--no-timings", *EDGES)
        self.assertEqual(made.returncode, 0, made.stderr)
        for path in sorted(out.rglob("*")):
            if path.is_file() and path.parent.name != "dicom":
                self.assert_clean(path.read_bytes(), path.name)
        held = b"".join(path.read_bytes() for path in (out / "dicom").iterdir())
        self.assertIn(b"20090813", held, "DICOM results belong to the study of that day")
        again = run("rerun", out, "--study", study())
        self.assertEqual(again.returncode, 0, again.stdout + again.stderr)
        self.assertIn("same bytes", again.stdout)

    def test_what_is_made_of_a_study_names_nobody(self):
        self.clean("borders", study(), "--edges-only", out="edges")
        for command in ("borders", "organ"):
            self.clean(command, study(), out=command)
        self.clean("info", study(), out=None)
        self.clean("info", study(), "--json", out=None)

    def test_what_is_made_of_a_result_names_nobody(self):
        self.assertIn("dynasurf.ventricle/3", (result() / "results.json").read_text())
        self.assert_clean((result() / "results.json").read_bytes(), "results.json")
        self.clean("perfusion", "score", result(), out="scores.json")
        self.clean("solid", result(), out="wall.vtu")
        for n in (2, 3):
            other = result().parent / f"CANARY_HANS_{n}"
            if not other.exists():
                shutil.copytree(result(), other)
        self.clean("perfusion", "build", result().parent, out="normals.json")

    def test_a_comparison_links_results_by_name_only_when_asked(self):
        both = self.clean("perfusion", "compare", result(), result())
        self.assertNotIn("<a href", (both / "comparison.html").read_text())
        named = run("perfusion", "compare", result(), result(), "--out", self.folder / "named", "--with-names")
        self.assertEqual(named.returncode, 0, named.stderr)
        self.assertIn("CANARY_HANS_1/report.html", (self.folder / "named" / "comparison.html").read_text())
        self.assertEqual(hashes(self.folder / "named")["comparison.json"], hashes(both)["comparison.json"])

    def test_what_is_made_of_scans_names_nobody(self):
        meshes = self.clean("cloud", scans(), "--triangles", "320,80") / "meshes"
        persons = self.folder / "CANARY"
        persons.mkdir()
        for name in ("level1", "level2"):
            shutil.copy(meshes / f"{name}.ply", persons / f"CANARY-{name}.ply")
        levels = [persons / "CANARY-level1.ply", persons / "CANARY-level2.ply"]
        lod = self.clean("lod", *levels, out="lod")
        self.assertEqual([level["name"] for level in self.read_json(lod / "lod.json")["levels"]], ["level1", "level2"])
        self.clean("measure", levels[0], out=None)
        named = run("lod", *levels, "--with-names", "--out", self.folder / "named")
        self.assertEqual(named.returncode, 0, named.stderr)
        names = [level["name"] for level in self.read_json(self.folder / "named" / "lod.json")["levels"]]
        self.assertEqual(names, ["CANARY-level1", "CANARY-level2"])

    def test_points_that_were_tracked_name_nobody(self):
        persons = self.folder / "CANARY"
        persons.mkdir()
        rows = [f"p{n},{gate},{(n % 4) * 10 + gate},{(n // 4 % 4) * 10},{n // 16 * 10}" for gate in (1, 2, 3)
                for n in range(64)]
        (persons / "CANARY.csv").write_text("point,gate,x_mm,y_mm,z_mm\n" + "\n".join(rows) + "\n")
        self.clean("motion", persons / "CANARY.csv", "--apex", "15,15,-5", "--base", "15,15,35")


if __name__ == "__main__":
    unittest.main()
