"""Files that lie about their size, or are damaged: refused in one line, soon, in little memory, never with a crash."""

import gzip
import os
import random
import resource
import socket
import struct
import subprocess
import tempfile
import time
import unittest
import zlib

from cli import PROGRAM, CliTest, run, small_patient

# The program with its libraries takes about 30 MB; the files below are small, so there is no reason for more.
MOST_MB = 128
MUTATIONS = int(os.environ.get("DYNASURF_MUTATIONS", "40"))  # per file; more in a campaign


def bomb(head=b"", megabytes=300):
    """A small gzip file that unpacks to much. Made in pieces: a child's peak of memory begins with its parent's."""
    packer = zlib.compressobj(9, zlib.DEFLATED, 31)
    return b"".join([packer.compress(head), *(packer.compress(bytes(1 << 20)) for _ in range(megabytes)),
                     packer.flush()])


def nrrd(sizes, body=b"", encoding="raw", kind="float"):
    axes = len(sizes)
    lines = ["NRRD0005", f"type: {kind}", f"dimension: {axes}", "space: left-posterior-superior",
             "sizes: " + " ".join(map(str, sizes)),
             "space directions: (3,0,0) (0,3,0) (0,0,6)" + " none" * (axes - 3),
             "kinds: domain domain domain" + " list" * (axes - 3), "endian: little", f"encoding: {encoding}"]
    return "\n".join(lines).encode() + b"\n\n" + body


def nifti(dims, body=b"", offset=352.0):
    header = bytearray(348)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, len(dims), *dims, *[1] * (7 - len(dims)))
    struct.pack_into("<hh", header, 70, 16, 32)
    struct.pack_into("<8f", header, 76, 1, 3, 3, 6, 50, 1, 1, 1)
    struct.pack_into("<f", header, 108, offset)
    header[123] = 2 | 16
    header[344:348] = b"n+1\0"
    return bytes(header) + bytes(4) + body


def nested_sequences(depth):
    """A DICOM file whose only element is a sequence in a sequence in a sequence ..."""
    meta = (struct.pack("<HH2sH", 2, 0x10, b"UI", 20) + b"1.2.840.10008.1.2.1\0")
    head = bytes(128) + b"DICM" + struct.pack("<HH2sHI", 2, 0, b"UL", 4, len(meta)) + meta
    begin = struct.pack("<HH2sHI", 0x0054, 0x0022, b"SQ", 0, 0xFFFFFFFF) + struct.pack("<HHI", 0xFFFE, 0xE000, 0xFFFFFFFF)
    end = struct.pack("<HHI", 0xFFFE, 0xE00D, 0) + struct.pack("<HHI", 0xFFFE, 0xE0DD, 0)
    return head + begin * depth + end * depth


def small_elements(megabytes):
    """A DICOM file of private elements of two bytes each, in an order that nobody asked for."""
    head = nested_sequences(0)
    element = b"".join(struct.pack("<HH2sH2s", 0x29, n, b"LO", 2, b"ab") for n in range(10_000, 0, -1))
    return head + element * (megabytes * 1_000_000 // len(element))


def patched(data, tag, value):
    """A DICOM file with the 16-bit value of one element replaced."""
    at = data.index(struct.pack("<HH2sH", *tag, b"US", 2)) + 8
    return data[:at] + struct.pack("<H", value) + data[at + 2:]


def studies():
    dicom = (small_patient() / "study.dcm").read_bytes()
    return {
        "raw.nrrd": nrrd([1024, 1024, 1024]),
        "most.nrrd": nrrd([1000, 1000, 134, 4]),
        "overflow.nrrd": nrrd([4294967296, 4294967296, 4294967296]),
        "minus.nrrd": nrrd([-64, -64, 23]),
        "short_gzip.nrrd": nrrd([600, 600, 600], gzip.compress(bytes(200)), "gzip"),
        "bomb.nrrd": nrrd([4, 4, 4], bomb(), "gzip"),
        "raw.nii": nifti([32767, 32767, 32767]),
        "most.nii": nifti([1000, 1000, 134, 4]),
        "far.nii": nifti([4, 4, 4], bytes(256), offset=3e9),
        "not_a_number.nii": nifti([4, 4, 4], bytes(256), offset=float("nan")),
        "short.nii.gz": gzip.compress(nifti([600, 600, 600])),
        "bomb.nii.gz": bomb(nifti([4, 4, 4])),
        "rows.dcm": patched(dicom, (0x28, 0x10), 65535),
        "rows_and_columns.dcm": patched(patched(dicom, (0x28, 0x10), 65535), (0x28, 0x11), 65535),
        "pixel_length.dcm": dicom[:dicom.rindex(struct.pack("<HH2s", 0x7FE0, 0x10, b"OW")) + 8] + b"\xfe\xff\xff\xff",
        "deep.dcm": nested_sequences(100),
        "very_deep.dcm": nested_sequences(200000),
        "small_elements.dcm": small_elements(20),
        "far.nii.gz": gzip.compress(nifti([4, 4, 4], bytes(256), offset=1e9)),
        "empty.dcm": b"",
        "noise.dcm": random.Random(1).randbytes(5000),
    }


def meshes():
    ply = "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n" \
          "element face {}\nproperty list uchar int vertex_indices\nend_header\n"
    return {
        "binary.ply": ply.format("binary_little_endian", 4294967295, 1).encode() + bytes(50),
        "ascii.ply": ply.format("ascii", 3, 4294967295).encode() + b"0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "count.stl": bytes(80) + b"\xff\xff\xff\xff" + bytes(50),
        "count.off": b"OFF\n4294967295 4294967295 0\n0 0 0\n",
        "face.off": b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4294967295 0 1 2\n",
        "index.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4294967295\n",
        "empty.ply": b"",
        "noise.stl": random.Random(2).randbytes(5000),
    }


def clouds():
    las = bytearray(227)
    las[:4] = b"LASF"
    las[24:26] = b"\x01\x02"
    struct.pack_into("<HI", las, 94, 227, 227)
    struct.pack_into("<BHI", las, 104, 0, 20, 0xFFFFFFFF)
    struct.pack_into("<6d", las, 131, *[1.0] * 6)
    return {
        "count.las": bytes(las) + bytes(200),
        "count.pts": b"4294967295\n0 0 0\n",
        "wide.xyz": b"1 " * 3_000_000 + b"\n",
        "properties.ply": b"ply\nformat ascii 1.0\nelement vertex 1\n" +
                          b"".join(b"property float p%d\n" % n for n in range(60_000)) + b"end_header\n",
        "elements.ply": b"ply\nformat ascii 1.0\n" + b"".join(b"element e%d 0\n" % n for n in range(60_000)),
        "long.csv": b"x,y,z\n" + b"1" * 5_000_000 + b",2,3\n",
        "counts.xyz": b"0\n" * 500_000,
        "binary.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 4294967295\nproperty double x\n"
                      b"property double y\nproperty double z\nend_header\n" + bytes(48),
        "empty.xyz": b"",
        "noise.xyz": random.Random(3).randbytes(5000),
        "noise.las": b"LASF" + random.Random(4).randbytes(5000),
    }


class Lies(CliTest):
    def measured(self, *arguments, limits=()):
        """Exit code, standard error, most memory in MB and seconds of one run, under limits of the system."""
        def prepare():
            for which, value in limits:
                resource.setrlimit(which, (value, value))
        with tempfile.TemporaryFile() as errors:
            begin = time.monotonic()
            process = subprocess.Popen([PROGRAM, *map(str, arguments)], stdin=subprocess.DEVNULL,
                                       stdout=subprocess.DEVNULL, stderr=errors, preexec_fn=prepare)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            errors.seek(0)
            return process.returncode, errors.read().decode(), usage.ru_maxrss / 1024, time.monotonic() - begin

    def refused(self, *arguments, limits=()):
        code, errors, megabytes, seconds = self.measured(*arguments, limits=limits)
        self.assertEqual(code, 2, errors)
        self.assertEqual(len(errors.splitlines()), 1, errors)
        self.assertLess(megabytes, MOST_MB, errors)
        self.assertLess(seconds, 20, errors)
        return megabytes

    def test_studies_that_declare_more_than_they_hold(self):
        most = 0
        for name, data in studies().items():
            with self.subTest(name):
                path = self.folder / name
                path.write_bytes(data)
                most = max(most, self.refused("info", path))
        print(f"most memory: {most:.0f} MB")

    def test_a_small_file_of_a_huge_study_tells_the_memory_that_it_needs(self):
        header = bytearray(nifti([400, 400, 400]))
        struct.pack_into("<hh", header, 70, 2, 8)
        path = self.folder / "bomb.nii.gz"
        path.write_bytes(bomb(bytes(header), 61) + gzip.compress(bytes(400 ** 3 - (61 << 20))))
        for command in (["info", path], ["ventricle", path, "--out", self.folder / "out", "--quiet"]):
            code, errors, megabytes, _ = self.measured(*command, "--memory-limit", "4G")
            self.assertEqual(code, 2, errors)
            self.assertRegex(errors, r"needs \d+\.\d GiB of memory for 400 x 400 x 400 voxels x 1 gates; the limit is "
                                     r"4\.0 GiB \(--memory-limit\)")
            self.assertLess(megabytes, MOST_MB)

    def test_sequences_are_not_read_by_recursion(self):
        path = self.folder / "deep.dcm"
        for depth in (700, 1400):
            path.write_bytes(nested_sequences(depth))
            self.refused("info", path, limits=[(resource.RLIMIT_STACK, 1 << 20)])

    def test_memory_that_is_not_there_is_one_line(self):
        path = self.folder / "large.nrrd"
        path.write_bytes(nrrd([512, 512, 256], kind="uchar"))
        os.truncate(path, path.stat().st_size + 512 * 512 * 256)
        space = 300 << 20
        code, errors, _, _ = self.measured("info", path, limits=[(resource.RLIMIT_AS, space)])
        self.assertEqual(code, 2)
        self.assertIn("the limit is 150 MiB", errors)
        code, errors, _, _ = self.measured("info", path, "--memory-limit", "1T", limits=[(resource.RLIMIT_AS, space)])
        self.assertEqual((code, errors), (2, "dynasurf: error: out of memory\n"))

    def test_what_is_no_file_is_refused_at_once(self):
        for ending in ("dcm", "nii", "nrrd", "ply", "xyz", "las", "stl", "obj", "off", "csv"):
            pipe, place, link = (self.folder / f"{what}.{ending}" for what in ("pipe", "socket", "device"))
            os.mkfifo(pipe)
            with socket.socket(socket.AF_UNIX) as server:
                server.bind(str(place))
                link.symlink_to("/dev/zero")
                for path in (pipe, place, link):
                    self.refused("info", path)
                    self.refused("motion", path, "--out", self.folder / "out")
                    if ending in ("ply", "stl", "obj", "off"):
                        self.refused("measure", path)
                    if ending != "dcm":
                        self.refused("cloud", path, "--out", self.folder / "out", "--quiet")

    def test_meshes_that_declare_more_than_they_hold(self):
        for name, data in meshes().items():
            with self.subTest(name):
                path = self.folder / name
                path.write_bytes(data)
                self.refused("measure", path)

    def test_clouds_that_declare_more_than_they_hold(self):
        for name, data in clouds().items():
            with self.subTest(name):
                path = self.folder / name
                path.write_bytes(data)
                self.refused("cloud", path, "--out", self.folder / "out", "--quiet")
        self.assertFalse((self.folder / "out").exists())

    def test_the_main_job_leaves_nothing_behind_for_a_liar(self):
        path, out = self.folder / "study.nrrd", self.folder / "out"
        path.write_bytes(nrrd([1024, 1024, 1024]))
        self.refused("ventricle", path, "--out", out, "--quiet")
        self.assertEqual([p.name for p in self.folder.iterdir()], ["study.nrrd"])

    def test_damaged_files_are_read_or_refused_but_never_crash(self):
        rng = random.Random(20260102)
        patient = small_patient()
        files = {"info": [patient / "study.dcm", patient / "study.nii.gz"],
                 "measure": [patient / "truth" / "endo_g01.ply"]}
        for command, paths in files.items():
            for original in paths:
                data = original.read_bytes()
                for _ in range(MUTATIONS):
                    changed = bytearray(data)
                    # Mostly in the header, where numbers steer.
                    reach = min(len(changed), rng.choice([400, 4000, len(changed)]))
                    for _ in range(rng.randint(1, 6)):
                        changed[rng.randrange(reach)] = rng.choice([0, 1, 0x7F, 0x80, 0xFF, rng.randrange(256)])
                    if rng.random() < 0.2:
                        del changed[rng.randrange(len(changed)):]
                    path = self.folder / original.name
                    path.write_bytes(changed)
                    code, errors, megabytes, _ = self.measured(command, path)
                    self.assertIn(code, (0, 2), errors)
                    self.assertEqual(len(errors.splitlines()), 0 if code == 0 else 1, errors)
                    self.assertLess(megabytes, MOST_MB + 2 * len(data) / 1e6, errors)


if __name__ == "__main__":
    unittest.main()
