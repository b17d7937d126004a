"""Names of files are bytes: any of them work, and none of them steers the terminal."""

import os
import resource
import shutil
import subprocess
import unittest

from cli import EDGES, PROGRAM, CliTest, hashes, run, small_patient
from test_cloud import small_result, small_scan

# CSI as one character, right-to-left override, isolate, escape, delete: in UTF-8.
STEERING = "a\u009b31mb\u202ec\u2066d\x1be\x7ff"


def run_bytes(*arguments):
    words = [argument if isinstance(argument, bytes) else str(argument).encode() for argument in arguments]
    return subprocess.run([PROGRAM, *words], capture_output=True, stdin=subprocess.DEVNULL, timeout=120)


class Names(CliTest):
    def setUp(self):
        super().setUp()
        self.bytes = os.fsencode(self.folder)

    def test_that_are_not_utf8_are_recorded_with_their_bytes_written_out(self):
        study, cloud = self.bytes + b"/\xff.dcm", self.bytes + b"/Jos\xe9.ply"
        shutil.copy(small_patient() / "study.dcm", study)
        shutil.copy(small_scan(), cloud)
        for command, name, more in ((b"ventricle", study, EDGES), (b"cloud", cloud, ["--triangles", "320"])):
            out = self.folder / command.decode()
            made = run_bytes(command, name, "--out", out, "--with-names", *more)
            self.assertEqual(made.returncode, 0, made.stderr)
            made.stdout.decode(), made.stderr.decode()
            inputs = self.read_json(out / "results.json")["provenance"]["inputs"]
            self.assertEqual([entry["file"] for entry in inputs], ["\\xff.dcm" if name is study else "Jos\\xe9.ply"])
            (out / "report.html").read_text(encoding="utf-8")
            again = run_bytes("rerun", out, "--input", name)
            self.assertEqual(again.returncode, 0, again.stdout + again.stderr)

    def test_that_are_not_utf8_may_name_levels(self):
        meshes = []
        for n in (1, 2):
            meshes.append(self.bytes + b"/l\xe9vel%d.ply" % n)
            shutil.copy(small_result() / "meshes" / f"level{n}.ply", meshes[-1])
        made = run_bytes("lod", *meshes, "--with-names", "--out", self.bytes + b"/\xfe")
        self.assertEqual(made.returncode, 0, made.stderr)
        made.stdout.decode()
        with open(self.bytes + b"/\xfe/lod.json", encoding="utf-8") as file:
            self.assertIn("l\\\\xe9vel1", file.read())

    def test_that_are_not_utf8_may_stand_in_every_place(self):
        options = self.bytes + b"/\xe4.json"
        with open(options, "w") as file:
            file.write('{"edges": {"sigma_px": 1.5}}')
        study = self.bytes + b"/\xe4.dcm"
        shutil.copy(small_patient() / "study.dcm", study)
        first = self.bytes + b"/\xe4-1"
        made = run_bytes("ventricle", study, "--out", first, "--options", options, *EDGES)
        self.assertEqual(made.returncode, 0, made.stderr)
        for arguments in ((b"info", study), (b"info", study, b"--json"), (b"borders", b"--edges-only", study, b"--out", self.bytes + b"/\xe4-2"),
                          (b"borders", study, b"--out", self.bytes + b"/\xe4-3"),
                          (b"perfusion", b"score", first, b"--out", self.bytes + b"/\xe4.scores"),
                          (b"perfusion", b"compare", first, first, b"--with-names", b"--out", self.bytes + b"/\xe4-4"),
                          (b"solid", first, b"--out", self.bytes + b"/\xe4.vtu"),
                          (b"measure", first + b"/meshes/endo_g01.ply", b"--json"),
                          (b"phantom", b"hebron", b"--out", self.bytes + b"/\xe4-5"),
                          (b"rerun", first, b"--study", study)):
            done = run_bytes(*arguments)
            self.assertEqual(done.returncode, 0, (arguments, done.stderr))
            (done.stdout + done.stderr).decode()
        with open(self.bytes + b"/\xe4-4/comparison.html", encoding="utf-8") as file:
            self.assertIn("%E4-1/report.html", file.read())

    def test_reach_the_terminal_without_what_steers_it(self):
        refused = run("info", self.folder / STEERING)
        self.assertEqual((refused.returncode, refused.stderr.count("\n")), (2, 1))
        made = run("phantom", "hebron", "--out", self.folder / STEERING)
        self.assertEqual(made.returncode, 0, made.stderr)
        for text in (refused.stderr, made.stdout):
            self.assertIn("a\\u009b31mb\\u202ec\\u2066d\\u001be\\u007ff", text)
            for character in "\u009b\u202e\u2066\x1b\x7f":
                self.assertNotIn(character, text)
        self.assertIn("Jos\u00e9 \u8840", run("info", self.folder / "Jos\u00e9 \u8840").stderr, "other letters stay")


class Reasons(CliTest):
    def test_a_loop_of_links_is_named(self):
        loop = self.folder / "loop"
        loop.symlink_to(loop)
        line = self.refuses(2, "lod", loop, says=["loop: ", "Too many levels of symbolic links"])
        self.assertNotIn("filesystem error", line)

    def test_too_little_memory_for_a_thread_is_told(self):
        """With less and less address space: done, or one line that tells the reason, and never a crash."""
        said = set()
        for megabytes in range(120, 20, -1):
            limit = {"preexec_fn": lambda m=megabytes: resource.setrlimit(resource.RLIMIT_AS, (m << 20, m << 20))}
            if run("--version", **limit).returncode != 0:
                break  # before main: a library does not fit, or the static objects of one do not
            done = run("measure", small_result() / "meshes" / "level1.ply", **limit)
            self.assertIn(done.returncode, (0, 2), f"{megabytes} MB: {done.stderr}")
            if done.returncode == 2:
                self.assertEqual(done.stderr.count("\n"), 1)
                self.assertRegex(done.stderr, "^dynasurf: error: (cannot start .*thread.*ulimit .*-v|out of memory|.*needs .* of memory)")
                said.add(done.stderr)
        self.assertTrue(said)


if __name__ == "__main__":
    unittest.main()
