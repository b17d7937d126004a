"""From a scan to meshes, and what is done with the levels afterwards."""

import functools
import json
import math
import shutil
import signal
import struct
import subprocess
import time
import unittest
import zipfile
from xml.etree import ElementTree

from cli import PROGRAM, CliTest, hashes, run, shared_folder


@functools.cache
def small_scan():
    folder = shared_folder() / "scan"
    made = run("phantom", "cloud", "--seed", 3, "--out", folder, "--set", "shape=ellipsoid", "--set", "points=4000")
    assert made.returncode == 0, made.stderr
    return folder / "cloud.ply"


@functools.cache
def small_result():
    folder = shared_folder() / "cloud-result"
    made = run("cloud", small_scan(), "--out", folder, "--triangles", "640,160")
    assert made.returncode == 0, made.stdout + made.stderr
    return folder


def glb_json(path):
    data = path.read_bytes()
    magic, version, size, length = struct.unpack_from("<4sIII", data)
    assert (magic, version, size) == (b"glTF", 2, len(data))
    return json.loads(data[20:20 + length])


def e57(points):
    """A file of one scan, by ASTM E2807: pages with checksums, a section with one packet per 500 points, a text."""
    place = lambda at: at // 1020 * 1024 + at % 1020
    packets = b""
    for begin in range(0, len(points), 500):
        part = points[begin:begin + 500]
        axes = [struct.pack(f"<{len(part)}d", *axis) for axis in zip(*part)]
        body = struct.pack("<H3H", 3, *map(len, axes)) + b"".join(axes)
        packets += struct.pack("<BBH", 1, 0, len(body) + 3) + body
    section = struct.pack("<B7xQQQ", 1, 32 + len(packets), 80, 0) + packets
    columns = "".join(f'<cartesian{axis} type="Float"/>' for axis in "XYZ")
    text = ('<?xml version="1.0" encoding="UTF-8"?><e57Root type="Structure"><data3D type="Vector"><vectorChild type="Structure">'
            f'<points type="CompressedVector" fileOffset="48" recordCount="{len(points)}"><prototype type="Structure">{columns}'
            '</prototype></points></vectorChild></data3D></e57Root>').encode()
    pages = -(-(48 + len(section) + len(text)) // 1020)
    header = struct.pack("<8sIIQQQQ", b"ASTM-E57", 1, 0, 1024 * pages, place(48 + len(section)), len(text), 1024)
    content = (header + section + text).ljust(1020 * pages, b"\0")
    table = [functools.reduce(lambda crc, _: crc >> 1 ^ 0x82F63B78 * (crc & 1), range(8), n) for n in range(256)]
    step = lambda crc, byte: crc >> 8 ^ table[(crc ^ byte) & 255]
    parts = [content[at:at + 1020] for at in range(0, len(content), 1020)]
    return b"".join(part + struct.pack(">I", functools.reduce(step, part, 0xFFFFFFFF) ^ 0xFFFFFFFF) for part in parts)


def ply_header(path):
    return path.read_bytes().split(b"end_header\n")[0].decode()


class Cloud(CliTest):
    def test_leaves_all_files_of_a_result(self):
        result = small_result()
        self.assertEqual(sorted(hashes(result)), ["levels.glb", "manifest.txt", "meshes/level1.ply", "meshes/level2.ply", "options.json",
                                                  "report.html", "results.csv", "results.json"])
        results = self.read_json(result / "results.json")
        self.assertEqual(results["schema"], "dynasurf.cloud/1")
        self.assertTrue(results["watertight"])
        self.assertEqual([level["triangles_asked"] for level in results["levels"]], [640, 160])
        for level in results["levels"]:
            self.assertLessEqual(level["triangles"], level["triangles_asked"])
            self.assertEqual(level["certificate"]["genus"], 0)
            # An ellipsoid is easy: a hundredth of its size would be a bad fit even with 160 triangles.
            self.assertLess(level["certificate"]["distances"]["cloud_to_mesh"]["mean_percent"], 1)
        self.assertEqual(results["cloud"]["points"], 4000)
        self.assertGreater(results["timings_s"]["read"], 0)
        # The program itself takes ten MiB or more, and no cloud so small a GiB.
        self.assertTrue(10 * 2**20 < results["memory"]["peak_bytes"] < 2**30)
        self.assertAlmostEqual(results["memory"]["bytes_per_point"], results["memory"]["peak_bytes"] / 4000, 3)
        self.assertEqual(len((result / "results.csv").read_text().splitlines()), 3)

    def test_measure_agrees_with_the_certificate(self):
        level = self.read_json(small_result() / "results.json")["levels"][0]
        measured = json.loads(run("measure", small_result() / "meshes" / "level1.ply", "--json").stdout)
        self.assertEqual(measured["triangles"], level["triangles"])
        self.assertTrue(measured["closed"] and measured["oriented"])
        self.assertEqual(measured["volume_ml"] * 1000, level["certificate"]["volume"])
        self.assertEqual(measured["components"], level["certificate"]["components"])

    def test_the_glb_holds_all_levels(self):
        gltf = glb_json(small_result() / "levels.glb")
        self.assertEqual(gltf["extensionsUsed"], ["MSFT_lod"])
        self.assertEqual(gltf["nodes"][0]["extensions"]["MSFT_lod"]["ids"], [1])
        coverage = gltf["nodes"][0]["extras"]["MSFT_screencoverage"]
        self.assertEqual(len(coverage), 2)
        self.assertGreater(coverage[0], coverage[1])
        self.assertEqual(gltf["scenes"][0]["nodes"], [0])

    def test_starts_from_the_hull(self):
        out = self.folder / "r"
        done = run("cloud", small_scan(), "--out", out, "--triangles", "160", "--start", "hull")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.read_json(out / "options.json")["start"], "hull")

    def test_judges_what_the_points_say(self):
        whole = self.read_json(small_result() / "results.json")
        self.assertEqual((whole["verdict"], whole["support"]["made_up_percent"]), ("ok", 0))
        data = small_scan().read_bytes().split(b"end_header\n")[1]
        points = [struct.unpack_from("<3d", data, 24 * n) for n in range(4000)]
        half = self.folder / "half.xyz"
        half.write_text("".join(f"{x} {y} {z}\n" for x, y, z in points if x > 0))
        done = run("cloud", half, "--out", self.folder / "r", "--triangles", "640", "--boundary", "close")
        self.assertEqual(done.returncode, 0)
        self.assertIn("verdict: check", done.stdout)
        self.assertIn("[cloud.holes]", done.stdout)
        results = self.read_json(self.folder / "r" / "results.json")
        self.assertEqual(results["verdict"], "check")
        self.assertTrue(results["watertight"])
        # What closes half of an ellipsoid comes back flat: about its middle section.
        self.assertGreater(results["support"]["made_up_percent"], 10)
        self.assertIn("property float confidence", ply_header(self.folder / "r" / "meshes" / "level1.ply"))
        self.assertIn("_CONFIDENCE", glb_json(self.folder / "r" / "levels.glb")["meshes"][0]["primitives"][0]["attributes"])
        strict = run("cloud", half, "--out", self.folder / "s", "--triangles", "640", "--strict", "--boundary", "close")
        self.assertEqual(strict.returncode, 3)
        self.assertTrue((self.folder / "s" / "results.json").exists())

    def test_leaves_a_terrain_open(self):
        scan = self.folder / "hills.xyz"
        places = [(x / 40, y / 40) for x in range(60) for y in range(60) if abs(x - 20) + abs(y - 30) > 9]
        scan.write_text("".join(f"{x} {y} {0.1 * math.sin(5 * x) * math.cos(3 * y):.6f}\n" for x, y in places))
        # By itself with its inner hole closed; trimmed with the hole left open, too.
        for words, taken, loops in (([], "keep", 1), (["--boundary", "trim"], "trim", 2)):
            out = self.folder / taken
            done = run("cloud", scan, "--out", out, "--triangles", "640,160", *words)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(f"open surface with {loops} boundary loop", done.stdout)
            self.assertNotIn("watertight", done.stdout)
            results = self.read_json(out / "results.json")
            self.assertEqual((results["boundary"], results["watertight"], results["cloud"]["boundary_loops"]),
                             (taken, False, loops))
            for level in results["levels"]:
                certificate = level["certificate"]
                self.assertEqual((certificate["boundary_loops"], certificate["genus"], certificate["volume"]), (loops, 0, None))
                self.assertEqual((certificate["manifold"], certificate["self_intersections"]), (True, 0))
                self.assertTrue((out / "meshes" / f"{level['name']}.ply").exists())
            self.assertEqual(run("lod", out, "--out", self.folder / f"{taken}_lod").returncode, 0)
            self.assertEqual(self.read_json(out / "options.json")["boundary"], "trim" if words else "auto")
        self.refuses(1, "cloud", scan, "--out", self.folder / "x", "--boundary", "open", says="auto, close, keep, trim")

    def test_lod_can_be_quiet(self):
        done = run("lod", small_result(), "--quiet")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        self.assertEqual(json.loads(run("lod", small_result(), "--quiet", "--json").stdout)["schema"], "dynasurf.lod/1")

    def test_quiet_leaves_the_terminal_alone(self):
        out = self.folder / "r"
        done = run("cloud", small_scan(), "--out", out, "--triangles", "160", "--quiet")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        done = run("cloud", small_scan(), "--out", out, "--triangles", "160", "--quiet", "--json")
        self.assertEqual(done.stdout, (out / "results.json").read_text())

    def test_writes_the_formats_that_are_asked_for(self):
        out = self.folder / "r"
        self.assertEqual(run("cloud", small_scan(), "--out", out, "--triangles", "160", "--mesh-format",
                             "stl,obj,off,vtp,glb,3mf").returncode, 0)
        self.assertEqual(sorted(path.name for path in (out / "meshes").iterdir()),
                         ["level1.3mf", "level1.glb", "level1.obj", "level1.off", "level1.stl", "level1.vtp"])
        gltf = glb_json(out / "meshes" / "level1.glb")
        self.assertEqual(gltf["accessors"][gltf["meshes"][0]["primitives"][0]["indices"]]["count"], 3 * 160)

    def test_a_3mf_file_is_an_archive_with_the_mesh(self):
        name = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
        terrain = self.folder / "terrain.xyz"
        terrain.write_text("".join(f"{x} {y} {math.sin(x / 7)}\n" for x in range(60) for y in range(60)))
        for scan, kind in ((small_scan(), "model"), (terrain, "surface")):
            out = self.folder / kind
            self.assertEqual(run("cloud", scan, "--out", out, "--triangles", "160", "--mesh-format", "off,3mf").returncode, 0)
            off = (out / "meshes" / "level1.off").read_text().splitlines()[3:]
            with zipfile.ZipFile(out / "meshes" / "level1.3mf") as archive:
                self.assertIsNone(archive.testzip())
                self.assertEqual(archive.namelist(), ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"])
                relation = ElementTree.fromstring(archive.read("_rels/.rels"))[0]
                model = ElementTree.fromstring(archive.read(relation.get("Target").lstrip("/")))
            self.assertEqual((model.tag, model.get("unit")), (name + "model", "millimeter"))
            [item] = model.iter(name + "item")
            [thing] = model.iter(name + "object")
            self.assertEqual((thing.get("id"), thing.get("type")), (item.get("objectid"), kind))
            vertices = [[float(v.get(axis)) for axis in "xyz"] for v in model.iter(name + "vertex")]
            triangles = [[int(t.get(corner)) for corner in ("v1", "v2", "v3")] for t in model.iter(name + "triangle")]
            self.assertEqual(vertices, [[float(word) for word in row.split()] for row in off[:len(vertices)]])
            self.assertEqual(triangles, [[int(word) for word in row.split()[1:]] for row in off[len(vertices):]])

    def test_carries_the_colours_of_the_points_to_the_meshes(self):
        rows = run("phantom", "cloud", "--out", self.folder / "scan", "--set", "points=1000")
        self.assertEqual(rows.returncode, 0)
        data = (self.folder / "scan" / "cloud.ply").read_bytes().split(b"end_header\n")[1]
        points = [struct.unpack_from("<3d", data, 24 * n) for n in range(1000)]
        xyz = self.folder / "coloured.xyz"
        xyz.write_text("".join(f"{x} {y} {z} {200 if x > 0 else 0} 30 0\n" for x, y, z in points))
        out = self.folder / "r"
        self.assertEqual(run("cloud", xyz, "--out", out, "--triangles", "320", "--mesh-format", "ply,obj").returncode, 0)
        self.assertTrue(self.read_json(out / "results.json")["cloud"]["has_colours"])
        self.assertIn("property uchar red", ply_header(out / "meshes" / "level1.ply"))
        self.assertIn("COLOR_0", glb_json(out / "levels.glb")["meshes"][0]["primitives"][0]["attributes"])
        self.assertFalse((out / "textured.glb").exists())
        vertices = [line.split() for line in (out / "meshes" / "level1.obj").read_text().splitlines() if line[:2] == "v "]
        for _, x, _, _, red, green, _ in vertices:
            self.assertAlmostEqual(float(green), 30 / 255, 3)
            if abs(float(x)) > 0.3:
                self.assertAlmostEqual(float(red), 200 / 255 if float(x) > 0 else 0, 3)

    def test_writes_normal_maps_when_asked_and_repeats_them(self):
        out = self.folder / "r"
        shutil.copy(small_scan(), self.folder / "scan.ply")
        done = run("cloud", self.folder / "scan.ply", "--out", out, "--triangles", "320,80", "--textures")
        self.assertEqual(done.returncode, 0, done.stderr)
        gltf = glb_json(out / "textured.glb")
        self.assertEqual([image["name"] for image in gltf["images"]], ["level1_normals", "level2_normals"])
        self.assertEqual(len(gltf["materials"]), 2)
        self.assertIn("TANGENT", gltf["meshes"][0]["primitives"][0]["attributes"])
        again = run("rerun", out)
        self.assertIn("same bytes: 8 files", again.stdout)

    def test_packs_the_levels_when_asked_and_repeats_them(self):
        out = self.folder / "r"
        shutil.copy(small_scan(), self.folder / "scan.ply")
        done = run("cloud", self.folder / "scan.ply", "--out", out, "--triangles", "1280,320", "--packed")
        self.assertEqual(done.returncode, 0, done.stderr)
        gltf = glb_json(out / "packed.glb")
        self.assertEqual([node["name"] for node in gltf["nodes"]], ["level1", "level2"])
        self.assertIn("KHR_mesh_quantization", gltf["extensionsRequired"])
        self.assertLess(3 * (out / "packed.glb").stat().st_size, (out / "levels.glb").stat().st_size)
        self.assertTrue(self.read_json(out / "results.json")["provenance"]["outputs"]["packed"])
        again = run("rerun", out)
        self.assertIn("same bytes: 8 files", again.stdout)

    def test_reads_several_files_as_one_cloud(self):
        rows = [line for line in (small_scan().parent / "cloud.ply").read_bytes().split(b"end_header\n")[1:]]
        points = [struct.unpack_from("<3d", rows[0], 24 * n) for n in range(4000)]
        for name, part in (("a.xyz", points[::2]), ("b.csv", points[1::2])):
            (self.folder / name).write_text("".join(f"{x!r},{y!r},{z!r}\n" for x, y, z in part))
        out = self.folder / "r"
        done = run("cloud", self.folder / "a.xyz", self.folder / "b.csv", "--out", out, "--triangles", "160")
        self.assertEqual(done.returncode, 0, done.stderr)
        results = self.read_json(out / "results.json")
        self.assertEqual(results["cloud"]["scans"], 2)
        self.assertEqual([f["points"] for f in results["cloud"]["files"]], [2000, 2000])
        self.assertEqual([i["file"] for i in results["provenance"]["inputs"]], ["input-1.xyz", "input-2.csv"])
        again = run("rerun", out)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertIn("same bytes", again.stdout)

    def test_equal_runs_give_equal_bytes_for_any_number_of_threads(self):
        for threads in (1, 2):
            run("cloud", small_scan(), "--out", self.folder / str(threads), "--triangles", "640,160", "--no-timings",
                "--threads", threads)
        self.assertEqual(hashes(self.folder / "1"), hashes(self.folder / "2"))

    def test_a_rerun_finds_the_cloud_by_its_hash(self):
        shutil.copytree(small_result(), self.folder / "result")
        shutil.copy(small_scan(), self.folder / "renamed.bin.ply")
        done = run("rerun", self.folder / "result")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("same bytes: 7 files", done.stdout)
        (self.folder / "renamed.bin.ply").unlink()
        self.refuses(2, "rerun", self.folder / "result", says="name it with --input", cwd=self.folder)

    def test_tells_options_like_every_other(self):
        done = run("options", "cloud")
        self.assertEqual(done.returncode, 0)
        self.assertIn("max_error_percent", done.stdout)
        self.assertNotEqual(done.stdout, run("options", "cloud", "--preset", "faithful").stdout)
        self.assertIn("shape", run("options", "phantom", "cloud").stdout)
        options = self.read_json(small_result() / "options.json")
        self.assertEqual(options["triangles"], [640, 160])
        out = self.folder / "r"
        self.assertEqual(run("cloud", small_scan(), "--out", out, "--options", small_result() / "options.json").returncode, 0)
        self.assertEqual(self.read_json(out / "options.json"), options)

    def test_refuses_wrong_options_in_one_line(self):
        out = self.folder / "r"
        for arguments, says in ((["--triangles", "320,640"], "triangles"), (["--triangles", "many"], "triangles"),
                                (["--genus", "two"], "genus"), (["--start", "cone"], "auto, field, sphere, ellipsoid, hull"), (["--preset", "best"], "shaped"),
                                (["--max-error", "much"], "max_error_percent"), (["--set", "cell=3"], "cells"),
                                (["--mesh-format", "ply,fbx"], "choices: ply, stl, obj, off, vtp, glb, 3mf")):
            self.refuses(1, "cloud", small_scan(), "--out", out, *arguments, says=says)
        self.assertFalse(out.exists())

    def test_the_same_points_as_e57_give_the_same_meshes(self):
        data = small_scan().read_bytes().split(b"end_header\n", 1)[1]
        row = len(data) // 4000
        places = [struct.unpack_from("<3d", data, row * n) for n in range(4000)]
        (self.folder / "scan.e57").write_bytes(e57(places))
        (self.folder / "scan.xyz").write_text("".join("%r %r %r\n" % place for place in places))
        for name in ("e57", "xyz"):
            made = run("cloud", self.folder / f"scan.{name}", "--out", self.folder / name, "--triangles", 320, "--quiet")
            self.assertEqual(made.returncode, 0, made.stderr)
        self.assertEqual((self.folder / "e57/meshes/level1.ply").read_bytes(), (self.folder / "xyz/meshes/level1.ply").read_bytes())

    def test_refuses_what_is_no_cloud(self):
        out = self.folder / "r"
        for name, text, says in (("few.xyz", "0 0 0\n1 0 0\n0 1 0\n", "few.xyz"),
                                 ("flat.xyz", "".join(f"{x} {y} 0\n" for x in range(9) for y in range(9)), "plane"),
                                 ("cut.ply", small_scan().read_bytes()[:5000], "cut.ply"),
                                 ("words.xyz", "1 2 3\none two three\n", "line 2"),
                                 ("scan.e57", "x", "begins with 'ASTM-E57'"), ("scan.bin", "x", "unknown kind")):
            path = self.folder / name
            path.write_bytes(text if isinstance(text, bytes) else text.encode())
            self.refuses(2, "cloud", path, "--out", out, "--quiet", says=says)
        self.refuses(2, "cloud", self.folder / "absent.ply", "--out", out, says="absent.ply")
        self.assertFalse(out.exists())

    def test_a_former_result_is_replaced_and_anything_else_is_not(self):
        out = self.folder / "r"
        out.mkdir()
        (out / "precious.txt").write_text("mine")
        self.refuses(2, "cloud", small_scan(), "--out", out)
        self.assertEqual((out / "precious.txt").read_text(), "mine")

    def test_stops_on_request_and_leaves_nothing(self):
        scan = self.folder / "scan"
        run("phantom", "cloud", "--out", scan, "--set", "shape=blobs", "--set", "points=200000")
        out = self.folder / "r"
        process = subprocess.Popen([PROGRAM, "cloud", scan / "cloud.ply", "--out", out, "--set", "triangles=40000,20000"],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        # The first words of progress tell that the work has begun.
        process.stderr.readline()
        time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=100)
        self.assertEqual(process.returncode, 3, errors)
        self.assertIn("stopped on request", errors)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["scan"])

    def test_says_when_a_level_is_not_watertight(self):
        # The thesis's recipe crosses itself where a body is thin: the certificate must say so, and nothing may hide it.
        scan = self.folder / "scan"
        run("phantom", "cloud", "--out", scan, "--set", "shape=plate", "--set", "points=5000")
        out = self.folder / "r"
        done = run("cloud", scan / "cloud.ply", "--out", out, "--preset", "thesis", "--triangles", "1280")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("level 1 is not watertight", done.stdout)
        results = self.read_json(out / "results.json")
        self.assertFalse(results["watertight"])
        self.assertEqual(results["levels"][0]["name"], "level1_not_watertight")
        self.assertEqual([path.name for path in (out / "meshes").iterdir()], ["level1_not_watertight.ply"])
        self.assertEqual(glb_json(out / "levels.glb")["nodes"][0]["name"], "level1_not_watertight")


class Lod(CliTest):
    def test_tells_which_level_serves_at_which_distance(self):
        done = run("lod", small_result(), "--screen", "1920x1080", "--fov", "40", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        lod = json.loads(done.stdout)
        self.assertEqual([level["triangles"] for level in lod["levels"]],
                         [level["triangles"] for level in self.read_json(small_result() / "results.json")["levels"]])
        first, second = lod["levels"]
        self.assertEqual(first["from_distance"], 0)
        self.assertEqual(first["to_distance"], second["from_distance"])
        self.assertIsNone(second["to_distance"])
        narrow = json.loads(run("lod", small_result(), "--fov", "20", "--json").stdout)
        # Twice as large on the screen at nearly half the field: tan(20 deg) / tan(10 deg) = 2.064.
        self.assertAlmostEqual(narrow["levels"][1]["from_distance"] / second["from_distance"], 2.064, 3)
        small = json.loads(run("lod", small_result(), "--screen", "960x540", "--json").stdout)
        self.assertAlmostEqual(small["levels"][1]["from_distance"] / second["from_distance"], 0.5, 9)

    def test_writes_transitions_and_a_page(self):
        out = self.folder / "lod"
        done = run("lod", small_result(), "--out", out, "--steps", "3")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(hashes(out)), ["instances.html", "lod.json", "manifest.txt",
                                               *[f"transitions/level2_to_level1_{n}.ply" for n in range(5)]])
        volumes = [json.loads(run("measure", out / "transitions" / f"level2_to_level1_{n}.ply", "--json").stdout)["volume_ml"]
                   for n in range(5)]
        levels = [level["certificate"]["volume"] / 1000 for level in self.read_json(small_result() / "results.json")["levels"]]
        self.assertAlmostEqual(volumes[4] / levels[0], 1, places=12)  # summed over other triangles
        self.assertAlmostEqual(volumes[0] / levels[1], 1, delta=1e-6)
        for step, volume in enumerate(volumes):  # no jump on the way
            self.assertAlmostEqual(volume / (levels[1] + (levels[0] - levels[1]) * step / 4), 1, delta=0.005)
        told = self.read_json(out / "lod.json")["transitions"][0]["meshes"]
        self.assertGreater(told[0]["self_intersections"] + told[0]["flat_triangles"], 0)  # pieces of coarse triangles
        for mesh in told[1:]:
            self.assertTrue(mesh["closed"] and mesh["manifold"] and mesh["oriented"], mesh)
            self.assertEqual(mesh["self_intersections"] + mesh["flat_triangles"], 0)
        self.assertLess((out / "instances.html").stat().st_size, 2e6)
        # A former folder of this command is replaced.
        self.assertEqual(run("lod", small_result(), "--out", out, "--steps", "0").returncode, 0)
        self.assertEqual(len(list((out / "transitions").iterdir())), 2)

    def test_takes_mesh_files_too(self):
        meshes = small_result() / "meshes"
        done = run("lod", meshes / "level1.ply", meshes / "level2.ply")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("level 2 to 1", done.stdout)
        self.refuses(2, "lod", meshes / "level2.ply", meshes / "level1.ply", says="finest first")

    def test_serves_by_the_distances_of_the_user(self):
        lod = json.loads(run("lod", small_result(), "--from", "0,12.5", "--json").stdout)
        self.assertEqual([level["from_distance"] for level in lod["levels"]], [0, 12.5])
        # Twice as far is half as large: what the page compares with follows the distances.
        twice = json.loads(run("lod", small_result(), "--from", "0,25", "--json").stdout)
        self.assertAlmostEqual(lod["levels"][1]["largest_screen_px"] / twice["levels"][1]["largest_screen_px"], 2, 9)
        out = self.folder / "lod"
        printed = json.loads(run("lod", small_result(), "--from", "0,12.5", "--out", out, "--steps", "0", "--json").stdout)
        self.assertEqual(self.read_json(out / "lod.json"), printed)
        for transition in printed["transitions"]:  # what was written is told only where something was
            self.assertEqual([mesh["step"] for mesh in transition.pop("meshes")], [0, 1])
        self.assertEqual(printed, lod)

        def level_at(distance, *more):
            text = run("lod", small_result(), "--from", "0,12.5", "--distance", distance, *more).stdout
            return int(text.partition(": level ")[2].split()[0])
        self.assertEqual([level_at(12.4), level_at(12.6)], [1, 2])
        # Within 10 % of its limit a level stays that stands there.
        self.assertEqual([level_at(13, "--current", 1), level_at(13.9, "--current", 1), level_at(12, "--current", 2)], [1, 2, 2])

    def test_refuses_wrong_usage(self):
        for wrong in ("0", "0,3,2", "1,2", "0,5,6", "5,0"):
            self.refuses(1, "lod", small_result(), "--from", wrong, says="--from")
        self.refuses(1, "lod", small_result(), "--distance", "-1", says="--distance")
        self.refuses(1, "lod", small_result(), "--distance", "3", "--current", "9", says="--current")
        self.refuses(1, "lod", small_result(), "--screen", "1920", says="WIDTHxHEIGHT")
        self.refuses(1, "lod", small_result(), "--screen", "0x10", says="width_px")
        self.refuses(1, "lod", small_result(), "--fov", "180", says="fov_deg")
        self.refuses(2, "lod", self.folder, says="results.json")
        self.refuses(2, "lod", self.folder / "absent.ply", says="absent.ply")


class Phantom(CliTest):
    def test_makes_a_terrain_with_spikes(self):
        out = self.folder / "terrain"
        made = run("phantom", "terrain", "--out", out, "--set", "cells=20", "--set", "spike_mm=3")
        self.assertEqual(made.returncode, 0, made.stderr)
        truth = self.read_json(out / "truth.json")
        self.assertEqual((truth["vertices"], truth["triangles"]), (441, 800))
        self.assertGreater(truth["spikes"], 3)
        self.assertIn(f"{truth['spikes']} spikes", made.stdout)
        area = [json.loads(run("measure", path, "--json").stdout)["area_mm2"]
                for path in (out / "terrain.ply", out / "truth" / "surface.ply")]
        self.assertGreater(area[0], area[1] + 5 * truth["spikes"])
        self.assertIn("spike_every", run("options", "phantom", "terrain").stdout)
        self.refuses(1, "phantom", "terrain", "--out", out, "--seed", "2", says="no random numbers")

    def test_makes_a_scan_with_its_truth(self):
        out = self.folder / "p"
        done = run("phantom", "cloud", "--out", out, "--set", "shape=torus", "--set", "points=3000", "--set",
                   "missing_percent=20", "--set", "noise_percent=0.5", "--set", "normals=true")
        self.assertEqual(done.returncode, 0, done.stderr)
        truth = self.read_json(out / "truth.json")
        self.assertEqual((truth["genus"], truth["points"]), (1, 2400))
        self.assertIn("property float nx", ply_header(out / "cloud.ply"))
        self.assertGreater(truth["volume"], 0)
        first = hashes(out)
        run("phantom", "cloud", "--out", out, "--set", "shape=torus", "--set", "points=3000", "--set",
            "missing_percent=20", "--set", "noise_percent=0.5", "--set", "normals=true")
        self.assertEqual(hashes(out), first)
        self.refuses(1, "phantom", "cloud", "--out", out, "--nrrd", says="no volume")


if __name__ == "__main__":
    unittest.main()
