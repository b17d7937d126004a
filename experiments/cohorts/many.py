"""Thousands of studies in one folder: the worker's own memory and processor time, and the cost of having nothing to do.
One file in fifty is a virtual patient, the others are images of nothing: 40 ms each, so that the worker's share shows."""

import os
import pathlib
import shutil
import subprocess
import time

from cohort import QUICK, Memory, nifti, rows_of

HEARTS = 50  # one file in so many


def folder_of(bench, count):
    """A folder of `count` files, linked so that they take no space."""
    folder = bench.work / "many" / str(count)
    if folder.exists():
        return folder
    part = folder.with_suffix(".part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir(parents=True)
    nothing = bench.work / "many" / "nothing.nii"
    nothing.write_bytes(nifti(0.0))
    hearts = iter(rows_of(bench.work / "patients" / "patients.tsv"))
    for n in range(count):
        if n % HEARTS == 0:
            os.link(bench.work / "patients" / next(hearts)["path"], part / f"s{n:05d}.dcm")
        else:
            os.link(nothing, part / f"s{n:05d}.nii")
    part.rename(folder)
    return folder


class Watched:
    """A batch, with the processor seconds of the worker alone and what it held in memory."""

    def __init__(self, bench, folder, cohort):
        begin = time.monotonic()
        process = subprocess.Popen([bench.program, "batch", str(folder), "--out", str(cohort), "--jobs", "2", "--no-collect", "--quiet", "--", *QUICK],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True)
        self.memory, self.cpu_s = Memory(process), 0.0
        while process.poll() is None:
            try:
                fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rsplit(")", 1)[1].split()
                self.cpu_s = max(self.cpu_s, (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"))
            except (OSError, IndexError):
                pass
            time.sleep(0.01)
        self.seconds = time.monotonic() - begin
        if process.returncode != 0:
            raise SystemExit(process.stderr.read())


def many(bench, counts):
    for count in counts:
        cohort = bench.work / "many" / f"cohort-{count}"
        shutil.rmtree(cohort, ignore_errors=True)
        first = Watched(bench, folder_of(bench, count), cohort)
        again = Watched(bench, folder_of(bench, count), cohort)
        rows = rows_of(cohort / "status.tsv")
        done = sum(row["state"] == "done" for row in rows)
        bench.say(f"{count} studies in one folder: {done} done, {len(rows)} rows, {len({row['id'] for row in rows})} ids; "
                  f"{first.seconds:.0f} s, {60 * count / first.seconds:.0f} studies a minute")
        bench.say(f"  worker: {1000 * first.cpu_s / count:.2f} ms of a processor a study; memory after 10, 50, 90 % of the time "
                  f"{first.memory.at(0.1):.0f}, {first.memory.at(0.5):.0f}, {first.memory.at(0.9):.0f} MB")
        bench.say(f"  again, with nothing to do: {again.seconds:.2f} s, {1000 * again.cpu_s / count:.3f} ms of a processor a study, {again.memory.at(0.9):.0f} MB")
        widest = max(len(list(folder.iterdir())) for folder in (cohort / "studies").iterdir())
        bench.say(f"  results: at most {widest} folders in one")
        begin = time.monotonic()
        bench.must("collect", cohort, "--out", bench.work / "many" / f"tables-{count}", "--quiet", "--replace")
        bench.say(f"  collect: {time.monotonic() - begin:.1f} s; cohort.html {(bench.work / 'many' / f'tables-{count}' / 'cohort.html').stat().st_size / 1e6:.1f} MB")
