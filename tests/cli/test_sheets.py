"""`dynasurf borders`: pictures of all slices of every gate."""

import base64
import json
import re
import struct
import zlib
import unittest

from cli import CliTest, hashes, run, shared_folder, small_patient


def size_of_png(path):
    head = path.read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n" and head[12:16] == b"IHDR", path
    return struct.unpack(">II", head[16:24])


def decoded(path):
    """The rows of an 8-bit RGB PNG as lists of (red, green, blue), by the PNG specification."""
    data, at, packed = path.read_bytes(), 8, b""
    width, height = size_of_png(path)
    while at < len(data):
        length, name = struct.unpack(">I4s", data[at:at + 8])
        if name == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    raw, stride, before, rows = zlib.decompress(packed), 3 * width, bytearray(3 * width), []
    for y in range(height):
        kind, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            a, b, c = line[x - 3] if x >= 3 else 0, before[x], before[x - 3] if x >= 3 else 0
            if kind == 1:
                line[x] = (line[x] + a) & 255
            elif kind == 2:
                line[x] = (line[x] + b) & 255
            elif kind == 3:
                line[x] = (line[x] + (a + b) // 2) & 255
            elif kind == 4:
                p = a + b - c
                line[x] = (line[x] + min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]) & 255
        rows.append(list(zip(line[0::3], line[1::3], line[2::3])))
        before = line
    return rows


class Sheets(CliTest):
    def sheets(self, what, name, *arguments):
        folder = shared_folder() / name
        only = ["--edges-only"] if what == "edges" else []
        made = run("borders", small_patient() / "study.dcm", *only, "--out", folder, *arguments)
        self.assertEqual(made.returncode, 0, made.stdout + made.stderr)
        return folder, made.stdout

    def test_edges_draws_a_sheet_per_gate(self):
        folder, text = self.sheets("edges", "edges")
        names = {path.name for path in folder.iterdir()}
        self.assertEqual(names, {f"g0{g}_edges.png" for g in range(1, 5)} | {"manifest.txt", "options.json"})
        self.assertIn("edge pixels", text)

    def test_a_sheet_shows_as_many_edge_pixels_as_the_table_tells(self):
        """Yellow and orange squares on all sheets against the counts that are printed; a voxel is whole pixels wide."""
        folder, text = self.sheets("edges", "counted", "--set", "edges=canny")
        counts = [int(row.split()[1]) for row in text.splitlines() if re.match(r" *\d+ +\d+ +\d+$", row)]
        self.assertEqual(len(counts), 4, text)
        pixels = decoded(folder / "g01_edges.png")
        head = 110  # two pixels a point: title and legend end 55 points below the top
        shown = sum(row.count((240, 228, 66)) + row.count((230, 159, 0)) for row in pixels[head:])
        side = max(s for s in range(1, 40) if shown % (s * s) == 0 and shown // (s * s) == counts[0]) if counts[0] else 1
        self.assertGreaterEqual(side, 2)

    def test_json_tells_the_borders_and_fields_of_one_gate(self):
        study = small_patient() / "study.dcm"
        done = run("borders", study, "--json", "--gate", 2)
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)
        self.assertEqual((found["gate"], found["bin"]), (2, 1))

        def unpacked(text):
            return zlib.decompress(base64.b64decode(text))

        marks = unpacked(found["marks"])
        columns, rows, slices = found["grid"]["dims"]
        self.assertEqual(len(marks), columns * rows * slices)
        for name, bit in (("endo", 1), ("epi", 2)):
            around = found[name]
            border, first, dims = unpacked(around["border"]), around["first"], around["dims"]
            self.assertEqual(len(border), dims[0] * dims[1] * dims[2])
            self.assertEqual(len(unpacked(around["directions"])), 3 * len(border))
            # A closed border is the labelled one and its covers.
            labelled = covered = 0
            for n, mark in enumerate(marks):
                if not mark & bit:
                    continue
                at = [v - f for v, f in zip((n % columns, n // columns % rows, n // (columns * rows)), first)]
                labelled += 1
                covered += all(0 <= a < d for a, d in zip(at, dims)) and border[at[0] + dims[0] * (at[1] + dims[1] * at[2])]
            self.assertGreater(labelled, 100)
            self.assertGreater(covered, 0.8 * labelled)
        self.assertNotIn("failure", [note["severity"] for note in found["notes"]])
        lost = json.loads(run("borders", study, "--json", "--gate", 2, "--set", "manual.last_slice=3").stdout)["notes"]
        self.assertIn(("failure", "labels.no_endo", 2), [(note["severity"], note["code"], note["gate"]) for note in lost])
        for says, arguments in (("no --out", ["--out", self.folder / "no"]), ("study has 4", ["--gate", 9]),
                                ("one of them", ["--vary", "edges.low=0.1,0.2"]),
                                ("one of them", ["--edges-only"])):
            self.refuses(1, "borders", study, "--json", *arguments, says=says)
        self.refuses(1, "borders", study, says="--out is required")

    def test_a_heart_that_was_located_before_is_taken_as_it_was(self):
        study = small_patient() / "study.dcm"
        before = self.folder / "before.json"
        before.write_text(run("borders", study, "--json").stdout)
        changed = ["borders", study, "--json", "--gate", 3, "--set", "edges.high=0.4"]
        self.assertEqual(run(*changed, "--located", before).stdout, run(*changed).stdout)

        found = json.loads(before.read_text())
        found["heart"]["centre_mm"][0] += 25
        before.write_text(json.dumps({"heart": found["heart"]}))
        elsewhere = json.loads(run(*changed, "--located", before).stdout)
        self.assertEqual(elsewhere["heart"], found["heart"])
        self.assertNotEqual(elsewhere["marks"], json.loads(run(*changed).stdout)["marks"])

        for key, value, says in (("radius_mm", -1, "radius_mm > 0"), ("axis", [0, 0, 2], "length 1"),
                                 ("axis", [0, 1], "three numbers"), ("contrast", "a", "heart.contrast")):
            before.write_text(json.dumps({"heart": {**found["heart"], key: value}}))
            self.refuses(2, "borders", study, "--json", "--located", before, says=says)
        self.refuses(1, "borders", study, "--located", before, "--out", self.folder / "no", says="without --json")

    def test_borders_draws_edges_labels_and_rings(self):
        folder, text = self.sheets("borders", "borders")
        for kind in ("edges", "labels", "rings"):
            size_of_png(folder / f"g04_{kind}.png")
        self.assertIn("division slice", text)

    def test_every_detector_and_labeller_can_be_chosen(self):
        sheets = set()
        for method in ("canny", "canny_revised", "gradient", "sobel", "compass", "acc"):
            folder, _ = self.sheets("edges", "edges-" + method, "--set", "edges=" + method)
            self.assertEqual(json.loads((folder / "options.json").read_text())["edges"]["method"], method)
            sheets.add(hashes(folder)["g01_edges.png"])
            by_file, _ = self.sheets("edges", "edges-file-" + method, "--options", folder / "options.json")
            self.assertEqual(hashes(by_file), hashes(folder))
        self.assertEqual(len(sheets), 6)
        for method in ("none", "sign", "gradmag", "case", "radial"):
            folder, _ = self.sheets("borders", "borders-" + method, "--set", "labels.method=" + method)
            labels = json.loads((folder / "options.json").read_text())["labels"]
            self.assertEqual(labels["method"]["method"], method)
            by_file, _ = self.sheets("borders", "borders-file-" + method, "--options", folder / "options.json")
            self.assertEqual(hashes(by_file), hashes(folder))

    def test_a_slice_is_drawn_under_all_choices(self):
        wide, _ = self.sheets("edges", "wide", "--vary", "edges=canny,compass,sobel")
        high, _ = self.sheets("edges", "high", "--set", "edges.low=0.05", "--vary", "edges=canny,compass", "--vary",
                              "edges.sigma_px=0.6,1,1.8,3", "--gate", 2)
        labels, _ = self.sheets("borders", "choices", "--vary", "labels.method=none,radial,mlc", "--slice", 12)
        for folder in (wide, high, labels):
            self.assertEqual({path.name for path in folder.iterdir()}, {"manifest.txt", "matrix.png", "options.json"})
        self.assertGreater(size_of_png(wide / "matrix.png")[0], size_of_png(high / "matrix.png")[0])
        self.assertGreater(size_of_png(high / "matrix.png")[1], 2 * size_of_png(wide / "matrix.png")[1])
        # The whole is set before its parts: a value set for Compass is not lost when Compass is chosen.
        late, _ = self.sheets("edges", "late", "--set", "edges.low=0.3", "--vary", "edges=canny,compass", "--vary",
                               "edges.sigma_px=0.6,1,1.8,3", "--gate", 2)
        self.assertNotEqual(hashes(high)["matrix.png"], hashes(late)["matrix.png"])

    def test_choices_that_make_no_sense_are_refused(self):
        study = small_patient() / "study.dcm"
        for says, arguments in ((["--vary"], ["--vary", "edges"]), (["empty"], ["--vary", "edges=canny,,sobel"]),
                                (["twice"], ["--vary", "edges=canny"] * 3), (["--gate"], ["--vary", "edges=canny", "--gate", "5"]),
                                (["--slice"], ["--vary", "edges=canny", "--slice", "99"]),
                                (["edges.width"], ["--vary", "edges.width=1"])):
            self.refuses(1, "borders", study, "--edges-only", "--out", self.folder / "no", "--quiet", *arguments, says=says)
            self.assertFalse((self.folder / "no").exists())

    def test_the_same_bytes_for_any_number_of_threads(self):
        one, _ = self.sheets("borders", "one", "--threads", "1")
        three, _ = self.sheets("borders", "three", "--threads", "3")
        self.assertEqual(hashes(one), hashes(three))

    def test_replaces_its_own_sheets_and_nothing_else(self):
        self.sheets("edges", "again")
        self.sheets("edges", "again")
        other = shared_folder() / "other"
        other.mkdir()
        (other / "letter.txt").write_text("keep me")
        refused = run("borders", small_patient() / "study.dcm", "--edges-only", "--out", other)
        self.assertEqual(refused.returncode, 2)
        self.assertEqual((other / "letter.txt").read_text(), "keep me")


if __name__ == "__main__":
    unittest.main()
