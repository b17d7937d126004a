"""Twice the file costs at most 2.2 times the instructions, for every reader and for every shape of file that a reader
could stumble over. Counted, not timed, so that a busy machine changes nothing."""

import concurrent.futures
import gzip
import os
import re
import shutil
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

READER = os.environ.get("DYNASURF_READ_FILE", "")
# Sorting and trees have a logarithm: 2.13 times at the sizes below. Twice the square would be 4 times.
MOST = 2.2
# Memory taken in steps, and files that are refused at a limit, whatever follows.
SLACK = 400_000


def nifti(n):
    header = bytearray(348)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 4, 32, 32, 4, n, 1, 1, 1)
    struct.pack_into("<hh", header, 70, 4, 16)
    struct.pack_into("<8f", header, 76, 1, 3, 3, 6, 50, 1, 1, 1)
    struct.pack_into("<f", header, 108, 352.0)
    header[344:348] = b"n+1\0"
    return bytes(header) + bytes(4) + struct.pack(f"<{4096 * n}h", *(v % 251 for v in range(4096 * n)))


def nrrd(n, encoding="raw", list_first=False, extra=""):
    sizes, directions = ["32", "32", "4"], ["(3,0,0)", "(0,3,0)", "(0,0,6)"]
    at = 0 if list_first else 3
    sizes.insert(at, str(n))
    directions.insert(at, "none")
    body = bytes(v % 251 for v in range(4096 * n))
    return ("NRRD0005\ntype: uchar\ndimension: 4\nspace: LPS\nsizes: " + " ".join(sizes) + "\nspace directions: " +
            " ".join(directions) + f"\nencoding: {encoding}\nspace origin: (0,0,0)\n{extra}\n").encode() + \
        (body if encoding == "raw" else gzip.compress(body, 1))


def line_skip(folder, n):
    (folder / "voxels.raw").write_bytes(b"line\n" * (20000 * n) + bytes(64))
    return (f"NRRD0005\ntype: uchar\ndimension: 3\nspace: LPS\nsizes: 4 4 4\n"
            f"space directions: (3,0,0) (0,3,0) (0,0,6)\nencoding: raw\nspace origin: (0,0,0)\nline skip: {20000 * n}\ndata file: voxels.raw\n").encode()


def element(tag, vr, value):
    value += b"\0" * (len(value) % 2)
    head = struct.pack("<HH2s", tag >> 16, tag & 0xFFFF, vr)
    return head + (struct.pack("<HI", 0, len(value)) if vr in (b"OW", b"OB", b"SQ") else
                   struct.pack("<H", len(value))) + value


ENDLESS = b"\xff\xff\xff\xff"
ITEM, ITEM_END, END = b"\xfe\xff\x00\xe0", b"\xfe\xff\x0d\xe0\0\0\0\0", b"\xfe\xff\xdd\xe0\0\0\0\0"


def sequence(tag, items):
    return struct.pack("<HH2sH", tag >> 16, tag & 0xFFFF, b"SQ", 0) + ENDLESS + \
        b"".join(ITEM + ENDLESS + item + ITEM_END for item in items) + END


def dicom(frames, extra=b"", packed=False, position=None, number=0):
    def words(value):
        return struct.pack("<H", value)
    kind = b"ORIGINAL\\PRIMARY\\RECON TOMO\\EMISSION" if position is None else b"ORIGINAL\\PRIMARY"
    elements = {0x00080008: (b"CS", kind), 0x00080018: (b"UI", b"1.2.%d" % (number + 1)),
                0x00080060: (b"CS", b"NM" if position is None else b"PT"), 0x0020000E: (b"UI", b"1.3"),
                0x00280002: (b"US", words(1)), 0x00280010: (b"US", words(64)), 0x00280011: (b"US", words(64)),
                0x00280030: (b"DS", b"3\\3"), 0x00280100: (b"US", words(16)), 0x00280101: (b"US", words(16)),
                0x00280102: (b"US", words(15)), 0x00280103: (b"US", words(0))}
    if position is None:
        elements |= {0x00180088: (b"DS", b"6"), 0x00280008: (b"IS", str(frames).encode()),
                     0x00540081: (b"US", words(frames))}
    else:
        elements |= {0x00200032: (b"DS", b"0\\0\\%d" % position), 0x00200037: (b"DS", b"1\\0\\0\\0\\1\\0")}
    head = b"".join(element(tag, *elements[tag]) for tag in sorted(elements))
    syntax = element(0x00020010, b"UI", b"1.2.840.10008.1.2.5" if packed else b"1.2.840.10008.1.2.1")
    if packed:
        plane = (b"\x7f" + bytes(range(128))) * 32  # as it is, 128 bytes at a time
        frame = struct.pack("<16I", 2, 64, 64 + len(plane), *[0] * 13) + 2 * plane
        pixels = struct.pack("<HH2sH", 0x7FE0, 0x0010, b"OB", 0) + ENDLESS + ITEM + struct.pack("<I", 0) + \
            (ITEM + struct.pack("<I", len(frame)) + frame) * frames + END
    else:
        pixels = element(0x7FE00010, b"OW", bytes(range(256)) * (32 * frames))
    return bytes(128) + b"DICM" + syntax + head + extra + pixels


def private(tags):
    return b"".join(element(0x00290000 + tag, b"LO", b"ab") for tag in tags)


def slices(folder, n):
    place = folder / "study"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir()
    for k in range(n):
        (place / f"{k * 7919 % 10007}.dcm").write_bytes(dicom(1, position=6 * k, number=k))
    return place


def ply_header(rows):
    return f"ply\nformat ascii 1.0\nelement vertex {rows}\nproperty float x\nproperty float y\nproperty float z\n"


FACES = "element face {}\nproperty list uchar int vertex_indices\nend_header\n"


def points(n):
    return [f"{v % 977} {v % 463 + 0.5} {v}" for v in range(n)]


def triangles(n):
    return [(v, v + 1, v + 2) for v in range(n - 2)]


def ascii_ply(n):
    return "\n".join([ply_header(n) + FACES.format(n - 2) + points(n)[0], *points(n)[1:],
                      *("3 %d %d %d" % t for t in triangles(n))]) + "\n"


def binary_ply(n, order="<"):
    head = ply_header(n).replace("ascii", "binary_little_endian" if order == "<" else "binary_big_endian")
    return (head + FACES.format(n - 2)).encode() + \
        b"".join(struct.pack(order + "3f", v % 977, v % 463, v) for v in range(n)) + \
        b"".join(struct.pack(order + "B3i", 3, *t) for t in triangles(n))


def many(n, line):
    head = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
    return head + "".join(line.format(k) for k in range(n)) + "end_header\n"


def ascii_stl(n):
    facets = ("facet normal 0 0 1\nouter loop\nvertex 0 0 {0}\nvertex 1 0 {0}\nvertex 0 1 {0}\nendloop\nendfacet\n"
              .format(k) for k in range(n))
    return "solid a\n" + "".join(facets) + "endsolid a\n"


def binary_stl(n):
    return bytes(80) + struct.pack("<I", n) + b"".join(
        struct.pack("<12fH", 0, 0, 1, 0, 0, k, 1, 0, k, 0, 1, k, 0) for k in range(n))


def obj(n):
    return "".join(f"v {p}\n" for p in points(n)) + "".join("f %d %d %d\n" % (a + 1, b + 1, c + 1)
                                                          for a, b, c in triangles(n))


def off(n):
    return f"OFF\n{n} {n - 2} 0\n" + "\n".join([*points(n), *("3 %d %d %d" % t for t in triangles(n))]) + "\n"


def las(n):
    head = bytearray(227)
    head[:4] = b"LASF"
    head[24:26] = b"\x01\x02"
    struct.pack_into("<HI", head, 94, 227, 227)
    struct.pack_into("<BHI", head, 104, 2, 26, n)
    struct.pack_into("<6d", head, 131, 1, 1, 1, 0, 0, 0)
    # Every point has a scan of its own.
    return bytes(head) + b"".join(struct.pack("<3i6xH3H", k, k % 99, k % 7, k % 65536, 1, 2, 3) for k in range(n))


def tracked(gates):
    return "point,gate,x,y,z\n" + "".join(f"p{p},{g + 1},{p},{g},0.5\n" for g in range(gates) for p in range(100))


def plain(make):
    return lambda folder, n: make(n)


# name of the case: (kind, name of the file, smallest size, what makes the content or a folder)
CASES = {
    "NIfTI": ("study", "a.nii", 30, plain(nifti)),
    "NIfTI gzip": ("study", "a.nii.gz", 30, plain(lambda n: gzip.compress(nifti(n), 1))),
    "NRRD": ("study", "a.nrrd", 60, plain(nrrd)),
    "NRRD gzip": ("study", "a.nrrd", 60, plain(lambda n: nrrd(n, "gzip"))),
    "NRRD, gates first": ("study", "a.nrrd", 60, plain(lambda n: nrrd(n, list_first=True))),
    "NRRD, many keys": ("study", "a.nrrd", 4000,
                        plain(lambda n: nrrd(1, extra="".join(f"key {k * 7919 % 100003}:=v\n" for k in range(n))))),
    "NRRD, lines before": ("study", "a.nhdr", 2, line_skip),
    "DICOM": ("study", "a.dcm", 60, plain(dicom)),
    "DICOM in run lengths": ("study", "a.dcm", 60, plain(lambda n: dicom(n, packed=True))),
    "DICOM, tags ascend": ("study", "a.dcm", 8000, plain(lambda n: dicom(1, private(range(1, n))))),
    "DICOM, tags descend": ("study", "a.dcm", 8000, plain(lambda n: dicom(1, private(range(n, 0, -1))))),
    "DICOM, tags descend in an item that is read":
        ("study", "a.dcm", 8000,
         plain(lambda n: dicom(1, sequence(0x00540022, [private(range(n, 0, -1))])))),
    "DICOM, items that are read": ("study", "a.dcm", 2000,
                                   plain(lambda n: dicom(1, sequence(0x00540022, [b""] * n)))),
    "DICOM, items": ("study", "a.dcm", 20000, plain(lambda n: dicom(1, sequence(0x00551010, [b""] * n)))),
    "DICOM, depth": ("study", "a.dcm", 2000,
                     plain(lambda n: dicom(1, (struct.pack("<HH2sH", 0x55, 0x1010, b"SQ", 0) + ENDLESS + ITEM +
                                               ENDLESS) * n))),
    "DICOM folder": ("study", None, 20, slices),
    "PLY ascii": ("mesh", "a.ply", 5000, plain(ascii_ply)),
    "PLY little endian": ("mesh", "a.ply", 20000, plain(binary_ply)),
    "PLY big endian": ("mesh", "a.ply", 20000, plain(lambda n: binary_ply(n, ">"))),
    "PLY, properties": ("mesh", "a.ply", 250, plain(lambda n: many(n, "property float p{}\n"))),
    "PLY, too many properties": ("mesh", "a.ply", 10000, plain(lambda n: many(n, "property float p{}\n"))),
    "PLY, elements": ("mesh", "a.ply", 60, plain(lambda n: many(n, "element e{} 0\n"))),
    "PLY, too many elements": ("mesh", "a.ply", 10000, plain(lambda n: many(n, "element e{} 0\n"))),
    "PLY, comments": ("mesh", "a.ply", 20000, plain(lambda n: many(n, "comment c{}\n"))),
    "STL ascii": ("mesh", "a.stl", 3000, plain(ascii_stl)),
    "STL binary": ("mesh", "a.stl", 20000, plain(binary_stl)),
    "OBJ": ("mesh", "a.obj", 5000, plain(obj)),
    "OBJ, one face": ("mesh", "a.obj", 20000, plain(lambda n: "v 0 0 0\nf" + " 1" * n + "\n")),
    "OBJ, comments": ("mesh", "a.obj", 20000, plain(lambda n: "# 8 vertices\n" * n + "v 0 0 0\nf 1 1 1\n")),
    "OFF": ("mesh", "a.off", 5000, plain(off)),
    "cloud PLY": ("cloud", "a.ply", 20000,
                  plain(lambda n: binary_ply(n)[:-13 * (n - 2)].replace(b"face %d" % (n - 2), b"face 0"))),
    "cloud XYZ": ("cloud", "a.xyz", 10000, plain(lambda n: "\n".join(points(n)) + "\n")),
    "cloud CSV": ("cloud", "a.csv", 10000,
                  plain(lambda n: "x,y,z\n" + "\n".join(points(n)).replace(" ", ",") + "\n")),
    "cloud PTS of many scans": ("cloud", "a.pts", 10000, plain(lambda n: "".join(f"1\n{p}\n" for p in points(n)))),
    "cloud PWN": ("cloud", "a.pwn", 10000, plain(lambda n: "".join(f"{p} 0 0 1\n" for p in points(n)))),
    "cloud XYZ, one line": ("cloud", "a.xyz", 100000, plain(lambda n: "1 " * n + "\n")),
    "cloud XYZ, one long line": ("cloud", "a.xyz", 1000000, plain(lambda n: "1 " * n + "\n")),
    "cloud OBJ": ("cloud", "a.obj", 10000, plain(lambda n: "".join(f"v {p}\n" for p in points(n)))),
    "cloud LAS": ("cloud", "a.las", 10000, plain(las)),
    "tracked points": ("points", "a.csv", 50, plain(tracked)),
}


def instructions(kind, path):
    """What valgrind counts of one run of the reader."""
    run = subprocess.run(["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null", READER,
                          kind, path], capture_output=True, text=True, check=False)
    if run.returncode not in (0, 2):
        raise AssertionError(f"{path}: {run.returncode} {run.stdout[-500:]} {run.stderr[-500:]}")
    return int(re.search(r"I\s+refs:\s+([\d,]+)", run.stderr).group(1).replace(",", "")), run.stdout.strip()


def costs(case):
    """Instructions of a file, of twice and of four times as much, and what was said to the largest."""
    kind, name, size, make = CASES[case]
    counts = []
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        for n in (size, 2 * size, 4 * size):
            content = make(folder, n)
            path = folder / name if name else content
            if name:
                path.write_bytes(content.encode() if isinstance(content, str) else content)
            count, said = instructions(kind, path)
            counts.append(count)
    return counts, said


@unittest.skipUnless(shutil.which("valgrind"), "valgrind is not installed")
@unittest.skipUnless(READER, "DYNASURF_READ_FILE names no program")
class Growth(unittest.TestCase):
    def test_of_every_reader_is_linear(self):
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            for case, (counts, said) in zip(CASES, pool.map(costs, CASES)):
                with self.subTest(case):
                    one, two = counts[1] - counts[0], counts[2] - counts[1]
                    print(f"{case:45} {counts[0] / 1e6:8.1f} M + {one / 1e6:7.2f} M, + {two / 1e6:7.2f} M "
                          f"= {two / max(one, 1):.2f}  {said[-60:]}")
                    self.assertLessEqual(two, MOST * max(one, 0) + SLACK)


if __name__ == "__main__":
    unittest.main()
