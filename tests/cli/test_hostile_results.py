"""Folders of results pass from person to person, so they are input: whatever stands in them, a command that reads them
ends in one line, soon, and opens nothing outside. All folders here are made by hand."""

import copy
import functools
import json
import os
import pathlib
import resource
import shutil
import struct
import sys

from cli import CliTest, run, shared_folder


def sphere(radius, fineness=3):
    """Vertices and triangles of an octahedron that was divided and blown up."""
    vertices = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    triangles = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    for _ in range(fineness):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(vertices)
                sums = [x + y for x, y in zip(vertices[a], vertices[b])]
                length = sum(x * x for x in sums) ** 0.5
                vertices.append(tuple(x / length for x in sums))
            return middles[key]

        for a, b, c in triangles:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = finer
    return [tuple(radius * x for x in v) for v in vertices], triangles


def write_ply(path, mesh):
    vertices, triangles = mesh
    path.write_text("ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\nproperty double y\nproperty double z\n"
                    "element face %d\nproperty list uchar uint vertex_indices\nend_header\n" %
                    (len(vertices), len(triangles)) +
                    "".join("%r %r %r\n" % v for v in vertices) + "".join("3 %d %d %d\n" % t for t in triangles))


def glb_of(document, binary):
    text = document if isinstance(document, bytes) else json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    return (struct.pack("<4sIII4s", b"glTF", 2, 28 + len(text) + len(binary), len(text), b"JSON") + text +
            struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def glb_parts():
    """The document and the bytes of levels.glb with two levels."""
    document = {"asset": {"version": "2.0"}, "nodes": [], "meshes": [], "accessors": [], "bufferViews": []}
    binary = b""
    for n, fineness in enumerate((2, 1)):
        vertices, triangles = sphere(1, fineness)
        places = b"".join(struct.pack("<3f", *v) for v in vertices)
        corners = b"".join(struct.pack("<3I", *t) for t in triangles)
        for data, kind in ((places, "VEC3"), (corners, "SCALAR")):
            document["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
            document["accessors"].append({"bufferView": len(document["bufferViews"]) - 1, "type": kind,
                                          "componentType": 5126 if kind == "VEC3" else 5125,
                                          "count": len(data) // (12 if kind == "VEC3" else 4)})
            binary += data
        document["meshes"].append({"primitives": [{"attributes": {"POSITION": 2 * n}, "indices": 2 * n + 1}]})
        document["nodes"].append({"name": f"level{n + 1}", "mesh": n, "translation": [0, 0, 0]})
    document["buffers"] = [{"byteLength": len(binary)}]
    return document, binary


PROVENANCE = {"version": "0.1.0", "commit": "0123abc", "command": "dynasurf", "options": {},
              "outputs": {"mesh_formats": ["ply"], "textures": False, "keep_stages": False},
              "inputs": [{"file": "input-1.ply", "sha256": "0" * 64}], "given": {}}
CLOUD = {"schema": "dynasurf.cloud/1", "levels": [{"name": "level1"}, {"name": "level2"}], "timings_s": {},
         "provenance": PROVENANCE}
READING = {"edv_ml": 100, "esv_ml": 40, "ef_percent": 60}
PLANE = {"point_mm": [0, 0, 10], "normal": [0, 0, 1]}
VENTRICLE = {"schema": "dynasurf.ventricle/3", "reading": "psf_corrected", **READING,
             "readings": {"psf_corrected": {**READING, "edv_ml_90": [98, 102]}, "edge": READING},
             "heart": {"axis": [0, 0, 1]}, "quality": {"verdict": "ok", "flags": []},
             "gates": [{"endo_ml": 100, "base_plane": PLANE, "edge": {"endo_ml": 90, "base_plane": PLANE}}],
             "measures": {"thickness_is": "model", "perfusion_is": "counts", "anterior": {"direction": [0, 1, 0]},
                          "function": {"mean_ml": 70, "cosine_ml": [30, 1], "sine_ml": [5, 2]}},
             "timings_s": None, "provenance": PROVENANCE}


@functools.cache
def cloud_result():
    folder = shared_folder() / "hostile-cloud"
    folder.mkdir()
    (folder / "results.json").write_text(json.dumps(CLOUD))
    (folder / "levels.glb").write_bytes(glb_of(*glb_parts()))
    return folder


@functools.cache
def ventricle_result():
    folder = shared_folder() / "hostile-ventricle"
    (folder / "meshes").mkdir(parents=True)
    (folder / "measures").mkdir()
    (folder / "results.json").write_text(json.dumps(VENTRICLE))
    for prefix in ("", "edge_"):
        write_ply(folder / "meshes" / (prefix + "endo_g01.ply"), sphere(20))
        write_ply(folder / "meshes" / (prefix + "epi_g01.ply"), sphere(30))
    rows = ["%d,%d,100,%d" % (n // 48, n % 48, 60 + n % 40) for n in range(16 * 48)]
    (folder / "measures" / "polar.csv").write_text("ring,sector,area_mm2,perfusion_percent\n" + "\n".join(rows) + "\n")
    return folder


def hostile_texts():
    """Name -> bytes that no command may take for a results.json."""
    depth = 200000
    return {
        "deep lists": b'{"a":' + b"[" * depth + b"]" * depth + b"}",
        "deep objects": b'{"a":' * depth + b"1" + b"}" * depth,
        "deep and cut": b"[" * 5000000,
        "many keys": b"{" + b",".join(b'"k%d":%d' % (n, n) for n in range(100000)) + b"}",
        "many values": b'{"a":[' + b"0," * 3000000 + b"0]}",
        "a key twice": b'{"schema":"dynasurf.cloud/1","schema":"dynasurf.ventricle/3"}',
        "not UTF-8": b'{"schema":"\xff\xfe"}',
        "a zero byte": json.dumps(CLOUD).encode() + b"\0{}",
        "cut": json.dumps(CLOUD).encode()[:-1],
        "a second value": json.dumps(CLOUD).encode() + b"{}",
        "a huge number": b'{"schema":1e999}',
        "not a number": b'{"schema":NaN}',
        "a list": b"[]", "null": b"null", "nothing": b"", "an empty object": b"{}",
        "one long word": b'"' + b"a" * 3000000,
        "too large": b" " * (65 << 20),
    }


def name_of(command):
    return command[1] if command[0] == "perfusion" else command[0]


class Hostile(CliTest):
    def ends_soon(self, code, *arguments, says=()):
        """The program ends with `code` and one line that holds `says`, within 2 s of computing; 10 under a sanitizer's
        or an emulator's load."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        line = self.refuses(code, *arguments, says=says, timeout=120)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        took = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        self.assertLess(took, 2 * float(os.environ.get("DYNASURF_SLOWNESS", "1")), arguments)
        self.assertNotIn("json.exception", line)
        self.assertLess(len(line), 600)
        return line

    def copy_of(self, folder, name="result"):
        place = self.folder / name
        shutil.rmtree(place, ignore_errors=True)
        shutil.copytree(folder, place)
        return place

    def commands_on(self, folder):
        """Every command that reads a result of the ventricle."""
        many = folder.parent / "many"
        if not many.exists():
            many.mkdir()
            for name in "bcd":
                shutil.copytree(ventricle_result(), many / name)
            (many / "a").symlink_to(folder)
        other = ventricle_result()
        return [("rerun", folder), ("solid", folder, "--out", folder.parent / "wall.vtu"),
                ("perfusion", "compare", folder, other), ("perfusion", "compare", other, folder),
                ("perfusion", "score", folder), ("perfusion", "build", many, "--out", folder.parent / "n.json"),
                ("motion", self.points(), "--result", folder, "--out", folder.parent / "motion")]

    def points(self):
        path = self.folder / "points.csv"
        path.write_text("point,gate,x_mm,y_mm,z_mm\n" + "".join(
            f"p{n},{g},{25 * x},{25 * y},{25 * z}\n" for n, (x, y, z) in enumerate(sphere(1, 1)[0]) for g in (1, 2)))
        return path

    def test_the_folders_made_here_are_read_as_long_as_nothing_is_wrong(self):
        self.assertEqual(run("lod", cloud_result()).returncode, 0)
        folder = self.copy_of(ventricle_result())
        for command in self.commands_on(folder):
            done = run(*command)
            if command[0] == "rerun":
                self.assertIn("is neither beside it", done.stderr)
            elif command[0] != "motion":
                self.assertEqual(done.returncode, 0, (command, done.stderr))

    def test_results_json_that_is_no_json_of_ours_is_refused_by_every_command(self):
        result, cloud = self.copy_of(ventricle_result()), self.copy_of(cloud_result(), "cloud")
        for name, text in hostile_texts().items():
            (result / "results.json").write_bytes(text)
            (cloud / "results.json").write_bytes(text)
            for command in [*self.commands_on(result), ("lod", cloud)]:
                with self.subTest(text=name, command=command[0]):
                    self.ends_soon(2, *command, says="results.json: ")

    def test_results_json_that_is_no_file_is_refused_by_every_command(self):
        result, cloud = self.copy_of(ventricle_result()), self.copy_of(cloud_result(), "cloud")
        makers = {"a pipe": os.mkfifo, "a folder": os.mkdir, "a device": lambda p: os.symlink("/dev/zero", p),
                  "a loop": lambda p: os.symlink("results.json", p), "nothing": lambda p: None,
                  "a link out": lambda p: os.symlink(ventricle_result() / "results.json", p)}
        for name, make in makers.items():
            for folder in (result, cloud):
                place = folder / "results.json"
                if place.is_dir() and not place.is_symlink():
                    place.rmdir()
                else:
                    place.unlink(missing_ok=True)
                make(place)
            for command in [*self.commands_on(result), ("lod", cloud)]:
                with self.subTest(place=name, command=command[0]):
                    self.ends_soon(2, *command, says="results.json: ")

    def changed(self, path, value):
        """VENTRICLE with one value replaced, or left out when `value` is Ellipsis."""
        results = copy.deepcopy(VENTRICLE)
        *way, last = path
        at = results
        for key in way:
            at = at[key]
        if value is ...:
            del at[last]
        else:
            at[last] = value
        return json.dumps(results)

    def test_values_that_are_missing_or_of_another_kind_are_refused_by_those_who_need_them(self):
        result = self.copy_of(ventricle_result())
        commands = {name_of(command): command for command in self.commands_on(result)}
        wrong = [..., [], {}, 7, "a", [{}], [[]], {"": 0}]
        for path, readers in [
                (("reading",), ["solid", "compare"]), (("readings",), ["compare"]),
                (("readings", "psf_corrected"), ["compare"]), (("readings", "edge"), ["compare"]),
                (("readings", "psf_corrected", "edv_ml_90"), ["compare"]),
                (("gates",), ["solid", "compare"]), (("gates", 0, "edge"), ["compare"]),
                (("heart",), ["solid"]), (("heart", "axis"), ["solid"]),
                (("measures",), ["solid", "compare", "score", "build"]),
                (("measures", "perfusion_is"), ["compare", "score", "build"]),
                (("measures", "anterior"), ["solid"]), (("measures", "anterior", "direction"), ["solid"]),
                (("measures", "function", "sine_ml"), ["compare"]),
                (("quality",), ["compare"]), (("quality", "flags"), ["compare"]),
                (("provenance",), ["rerun"]), (("provenance", "options"), ["rerun"]),
                (("provenance", "inputs"), ["rerun"]), (("provenance", "inputs", 0), ["rerun"]),
                (("provenance", "outputs"), ["rerun"]), (("provenance", "outputs", "mesh_formats"), ["rerun"]),
                (("provenance", "version"), ["rerun"])]:
            for value in wrong:
                # What may be absent, empty, or is a word of its own.
                if (value is ... and path[-1] == "edv_ml_90") or \
                        (value == [] and path[-1] in ("flags", "mesh_formats")) or \
                        (value == {} and path[-1] == "options") or (value == "a" and path[-1] == "version"):
                    continue
                (result / "results.json").write_text(self.changed(path, value))
                for reader in readers:
                    if reader == "solid" and path[-1] == "gates" and value in ([{}], [[]]):
                        continue  # one gate, of which it needs nothing
                    with self.subTest(path=path, value=value, reader=reader):
                        self.ends_soon(2, *commands[reader], says="results.json: ")

    def test_well_typed_lies_crash_nothing(self):
        result = self.copy_of(ventricle_result())
        commands = self.commands_on(result)
        for path, value in [
                (("gates",), [{"endo_ml": 1}] * 100000), (("edv_ml",), -1e308), (("heart", "axis"), [0, 0, 0]),
                (("heart", "axis"), [1e308, 1e308, 1e308]), (("measures", "anterior", "direction"), [0, 0, 1]),
                (("measures", "function", "cosine_ml"), [1e308] * 2), (("measures", "function", "mean_ml"), 1e308),
                (("measures", "function", "cosine_ml"), [1] * 100000),
                (("gates", 0, "base_plane"), {"point_mm": [1e308, 0, 0], "normal": [0, 0, 1]}),
                (("gates",), [{"endo_ml": 1, "edge": {"endo_ml": 1}}] * 3),
                (("provenance", "inputs"), [{"file": "a", "sha256": "b"}] * 100000),
                (("provenance", "options"), {f"k{n}": n for n in range(100000)}),
                (("provenance", "outputs", "dicom"), True), (("quality", "verdict"), "\x1b[31m\u009b" * 1000)]:
            (result / "results.json").write_text(self.changed(path, value))
            for command in commands:
                with self.subTest(path=path, command=name_of(command)):
                    done = run(*command, timeout=120)
                    self.assertIn(done.returncode, (0, 1, 2, 3), done.stderr)
                    if done.returncode in (1, 2):
                        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
                        self.assertTrue(done.stderr.startswith("dynasurf: error: "), done.stderr)

    def test_tables_normal_maps_and_scores_of_a_person_are_read_with_the_same_care(self):
        result = self.copy_of(ventricle_result())
        table = result / "measures" / "polar.csv"
        for text in (b"", b"," * 30000000, b"area_mm2,perfusion_percent\n", b"\xff\xfe\n", b"\0" * 1000,
                     b"area_mm2,perfusion_percent\n" + b"1,2\n" * 3000000,
                     b"area_mm2,perfusion_percent\n1,nan\n", b"area_mm2,perfusion_percent\n" + b"9" * 1000000 + b",1\n"):
            table.write_bytes(text)
            for command in ("score", "compare", "build"):
                arguments = {name_of(c): c for c in self.commands_on(result)}[command]
                with self.subTest(text=text[:60], command=command):
                    self.ends_soon(2, *arguments, says="polar.csv")
        file = self.folder / "file.json"
        for name, text in hostile_texts().items():
            file.write_bytes(text)
            for option in ("--normals", "--edit"):
                if name == "an empty object" and option == "--edit":
                    continue  # no score is changed
                with self.subTest(text=name, option=option):
                    self.ends_soon(2, "perfusion", "score", ventricle_result(), option, file, says="file.json: ")
        for text in ('{"1": -9223372036854775808}', '{"1": 18446744073709551615}', '{"1e999": 1}', '{"-1": 1}',
                     '{"\\u009b1": 1}', '{"1": [1]}'):
            file.write_text(text)
            with self.subTest(text=text):
                self.ends_soon(2, "perfusion", "score", ventricle_result(), "--edit", file, says="file.json: ")

    def test_options_are_read_with_the_same_care(self):
        file = self.folder / "options.json"
        for name, text in hostile_texts().items():
            if name == "an empty object":
                continue  # nothing is set
            file.write_bytes(text)
            for command in ("ventricle", "cloud"):
                with self.subTest(text=name, command=command):
                    code = 2 if name == "too large" else 1
                    self.ends_soon(code, command, self.folder / "none", "--out", self.folder / "out", "--options", file,
                                   says="options.json: ")

    def test_names_of_levels_stay_in_their_folder(self):
        cloud = self.copy_of(cloud_result())
        (cloud / "meshes").mkdir()
        write_ply(self.folder / "secret.ply", sphere(1, 1))
        for name in ("../../secret", str(self.folder / "secret"), "a/../../../secret", "..", ".", "", "a" * 10000,
                     "a\0b", "a\nb", 7, None, ["level1"]):
            (cloud / "results.json").write_text(json.dumps({**CLOUD, "levels": [{"name": name}]}))
            with self.subTest(name=name):
                self.ends_soon(2, "lod", cloud, says="results.json: levels[0].name: ")
        (cloud / "results.json").write_text(json.dumps({**CLOUD, "levels": [{"name": "link"}]}))
        (cloud / "meshes" / "link.ply").symlink_to(self.folder / "secret.ply")
        self.ends_soon(2, "lod", cloud, says="link.ply: leads out of its folder")
        (cloud / "meshes" / "link.ply").unlink()
        os.mkfifo(cloud / "meshes" / "link.ply")
        self.ends_soon(2, "lod", cloud, says="link.ply: is not a regular file")
        for levels in ([], {}, 7, [7], [{}], [{"name": "level1"}] * 2, [{"name": "level1"}] * 500000,
                       [{"name": f"level{n}"} for n in range(3)]):
            (cloud / "meshes" / "link.ply").unlink(missing_ok=True)
            (cloud / "results.json").write_text(json.dumps({**CLOUD, "levels": levels}))
            with self.subTest(levels=levels if len(str(levels)) < 100 else "many"):
                self.ends_soon(2, "lod", cloud, says="result")

    def test_levels_glb_is_read_with_the_same_care(self):
        cloud = self.copy_of(cloud_result())
        os.mkfifo(cloud / "pipe.bin")

        def refused(document, says="levels.glb: "):
            (cloud / "levels.glb").write_bytes(glb_of(document, binary))
            return self.ends_soon(2, "lod", cloud, says=says)

        document, binary = glb_parts()
        for where, values in {
                ("accessors", "count"): [345, 100000, 0, -1, 2**64 - 1, 2**63, 1.5, "1", None],
                ("accessors", "byteOffset"): [2**64 - 4140, 2**63, -4, 4, 1, "1"],
                ("bufferViews", "byteOffset"): [2**64 - 4140, 2**63, -4, 10**9, 1],
                ("bufferViews", "byteLength"): [2**64 - 1, -1, 0, 10**9],
                ("bufferViews", "buffer"): [1, -1, 2**64 - 1], ("bufferViews", "byteStride"): [12],
                ("accessors", "bufferView"): [100, -1, None], ("accessors", "sparse"): [{"count": 1}],
                ("buffers", "uri"): ["pipe.bin", "/etc/passwd", "results.json", "data:,"],
                ("buffers", "byteLength"): [2**64 - 1, 0], ("nodes", "mesh"): [7, -1, 2**64 - 1],
                ("nodes", "translation"): [[], [1, 2], [1, 2, "3"], None]}.items():
            for value in values:
                changed = copy.deepcopy(document)
                changed[where[0]][0][where[1]] = value
                with self.subTest(where=where, value=value):
                    refused(changed)
        with self.subTest("sums that wrap around"):
            changed = copy.deepcopy(document)
            changed["bufferViews"][0]["byteOffset"] = 2**64 - 4140
            changed["accessors"][0].update(byteOffset=0, count=345)
            refused(changed)
        with self.subTest("pictures"):
            refused({**document, "images": [{"uri": "pipe.bin"}]}, "images[0]: names another file")
        with self.subTest("deep extras"):
            text = json.dumps(document).encode()[:-1]
            refused(text + b',"extras":' + b'{"a":' * 200000 + b"1" + b"}" * 200000 + b"}", "nested too deep")
        with self.subTest("the same numbers again and again"):
            refused({**document, "nodes": [document["nodes"][0]] * 100000}, "is used twice")
        for name, make in {"a pipe": os.mkfifo, "a link out": lambda p: os.symlink("/etc/passwd", p)}.items():
            (cloud / "levels.glb").unlink()
            make(cloud / "levels.glb")
            with self.subTest(name):
                self.ends_soon(2, "lod", cloud, says="levels.glb: ")


class Names(CliTest):
    """A name may hold bytes that are no UTF-8; what is written stays UTF-8, and the run is not lost."""

    def setUp(self):
        super().setUp()
        if sys.platform != "linux":
            self.skipTest("needs a file system that takes any bytes")

    def named(self, raw, source):
        path = os.fsencode(self.folder) + b"/" + raw
        shutil.copyfile(source, path)
        return os.fsdecode(path)

    def all_utf8(self, folder, endings=(".json", ".html", ".csv", ".svg")):
        for path in pathlib.Path(folder).rglob("*"):
            if path.suffix in endings:
                path.read_bytes().decode()  # throws where it is not

    def test_a_cloud_with_such_a_name_is_finished_and_repeated(self):
        made = run("phantom", "cloud", "--seed", 5, "--out", self.folder / "scan", "--set", "points=1000", "--quiet")
        self.assertEqual(made.returncode, 0, made.stderr)
        scan = self.named(b"Jos\xe9.ply", self.folder / "scan" / "cloud.ply")
        out = self.folder / "out"
        made = run("cloud", scan, "--out", out, "--triangles", "80", "--with-names", "--quiet")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.all_utf8(out)
        self.assertEqual(self.read_json(out / "results.json")["provenance"]["inputs"][0]["file"], "Jos\\xe9.ply")
        made = run("rerun", out, "--input", scan)
        self.assertEqual(made.returncode, 0, made.stdout + made.stderr)

    def test_levels_with_such_names_are_told(self):
        write_ply(self.folder / "fine.ply", sphere(1, 2))
        write_ply(self.folder / "coarse.ply", sphere(1, 1))
        fine, coarse = self.named(b"l\xe9vel1.ply", self.folder / "fine.ply"), self.folder / "coarse.ply"
        out = self.folder / "out"
        made = run("lod", fine, coarse, "--out", out, "--json", "--with-names")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.all_utf8(out)
        self.assertEqual(self.read_json(out / "lod.json")["levels"][0]["name"], "l\\xe9vel1")
