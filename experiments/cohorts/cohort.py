"""What the benchmarks of cohorts share: the program, tables, hashes, quick options."""

import csv
import hashlib
import os
import pathlib
import struct
import subprocess
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Small hearts, and the edge reading of them on coarse meshes: about 0.4 s of a processor each.
PATIENTS = ["--small", "--seed", "24", "--set", "gates=2", "--set", "irregular.walls=0",
            "--set", "lattice.nx=28", "--set", "lattice.ny=28", "--set", "lattice.nz=16"]
QUICK = ["--set", "fit.run=false", "--set", "mesh_level=1", "--set", "orientation.method=header", "--mesh-format", "ply"]


class Bench:
    """The program under test, and the folder that holds all that was made so far."""

    def __init__(self, program, work):
        self.program, self.work = str(pathlib.Path(program).resolve()), pathlib.Path(work).resolve()
        self.work.mkdir(parents=True, exist_ok=True)
        self.lines = []

    def run(self, *words, **options):
        return subprocess.run([self.program, *map(str, words)], capture_output=True, text=True, stdin=subprocess.DEVNULL, **options)

    def must(self, *words, codes=(0,), **options):
        done = self.run(*words, **options)
        if done.returncode not in codes:
            raise SystemExit(f"{' '.join(map(str, words))}: exit code {done.returncode}: {done.stderr[-500:]}")
        return done

    def say(self, text):
        """A line of the results."""
        self.lines.append(text)
        print(text, flush=True)


def rows_of(table):
    with open(table, newline="") as file:
        return list(csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE))


def write_table(path, columns, rows):
    path.write_text("\t".join(columns) + "\n" + "".join("\t".join(map(str, row)) + "\n" for row in rows))


def result_of(cohort, name):
    return cohort / "studies" / hashlib.sha256(name.encode()).hexdigest()[:2] / name


def digest_of(folder):
    """One hash of the names and the bytes of all files below a folder."""
    digest = hashlib.sha256()
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        data = path.read_bytes()
        digest.update(f"{path.relative_to(folder)}\0{len(data)}\0".encode() + data)
    return digest.hexdigest()


def nifti(value, gates=2, across=8, slices=6, step_mm=9.0):
    """A gated NIfTI study of equal voxels."""
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 4, across, across, slices, gates, 1, 1, 1)
    struct.pack_into("<2h", header, 70, 16, 32)
    struct.pack_into("<8f", header, 76, 1, step_mm, step_mm, step_mm, 500, 1, 1, 1)
    struct.pack_into("<f", header, 108, 352)
    header[123] = 2 | 16
    struct.pack_into("<h", header, 254, 1)
    for row in range(3):
        struct.pack_into("<4f", header, 280 + 16 * row, *(step_mm if n == row else 0.0 for n in range(4)))
    header[344:348] = b"n+1\0"
    return bytes(header) + struct.pack("<f", value) * (across * across * slices * gates)


class Memory:
    """The memory that a process holds, looked at until it ends."""

    def __init__(self, process):
        self.seen_mb, self.process = [], process
        self.thread = threading.Thread(target=self.watch)
        self.thread.start()

    def watch(self):
        while self.process.poll() is None:
            try:
                status = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
                self.seen_mb.append(int(status.split("VmRSS:")[1].split()[0]) / 1024)
            except (OSError, IndexError):
                pass
            time.sleep(0.05)

    def at(self, share):
        """MB held after this share of its life."""
        self.thread.join()
        return self.seen_mb[min(len(self.seen_mb) - 1, int(share * len(self.seen_mb)))] if self.seen_mb else float("nan")


def lanes(commands, count=2):
    """Runs commands `count` at a time; seconds that took, and processor seconds."""
    waiting, lock = list(reversed(commands)), threading.Lock()

    def lane():
        while True:
            with lock:
                if not waiting:
                    return
                words, check = waiting.pop()
            check(subprocess.run(words, capture_output=True, text=True, stdin=subprocess.DEVNULL))

    before, begin = os.times(), time.monotonic()
    threads = [threading.Thread(target=lane) for _ in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    after = os.times()
    return time.monotonic() - begin, after.children_user + after.children_system - before.children_user - before.children_system
