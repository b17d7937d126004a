"""Virtual patients, each listed as two studies, some of which are spoiled on purpose, whose workers are killed again and
again: nothing is lost, and all good ones have the bytes of single runs."""

import os
import random
import shutil
import subprocess
import time

from cohort import PATIENTS, QUICK, digest_of, lanes, nifti, result_of, rows_of, write_table

# What is done to a study, and what its row must say.
KINDS = {"truncated": "", "no-heart": "", "nan": "", "hangs": "time limit of 60 s", "killed": "killed from outside, signal 9",
         "memory": "the limit is 600 MiB", "crashes": "crashed, signal 11"}
FAULTS = {"hangs": "hang", "killed": "kill", "memory": "memory", "crashes": "crash"}


def make_studies(bench, count):
    """Rows of studies: `count / 2` patients, each under two ids."""
    table = bench.work / "patients" / "patients.tsv"
    if not table.exists() or len(rows_of(table)) != count // 2:
        bench.must("phantom", "patients", "--count", count // 2, "--out", bench.work / "patients", "--quiet", *PATIENTS)
    return [{**row, "patient": row["id"], "id": f"{row['id']}-{copy}"} for copy in "ab" for row in rows_of(table)]


def spoil(bench, rows, every):
    """The table of studies, and the kind of every one that is spoiled: one of so many."""
    folder = bench.work / "spoiled"
    folder.mkdir(exist_ok=True)
    if not (folder / "organ" / "study.dcm").exists():
        bench.must("phantom", "organ", "--out", folder / "organ", "--quiet")
    kinds = {row["id"]: list(KINDS)[n // every % len(KINDS)] for n, row in enumerate(rows) if n % every == every // 2}
    table = []
    for row in rows:
        name, kind, path = row["id"], kinds.get(row["id"]), bench.work / "patients" / row["path"]
        if kind == "truncated":
            (folder / f"{name}.dcm").write_bytes(path.read_bytes()[:path.stat().st_size // 2])
        elif kind == "nan":
            (folder / f"{name}.nii").write_bytes(nifti(float("nan")))
        table.append((name, {"truncated": folder / f"{name}.dcm", "nan": folder / f"{name}.nii",
                             "no-heart": folder / "organ" / "study.dcm"}.get(kind, path), row["sex"]))
    write_table(bench.work / "studies.tsv", ("id", "path", "sex"), table)
    return {name: path for name, path, _ in table}, kinds


def run_alone(bench, paths):
    """The digest of what the bare program makes of each file; goes on where it was."""
    table = bench.work / "alone.tsv"
    if not table.exists():
        write_table(table, ("path", "digest"), [])
    known = {row["path"] for row in rows_of(table)}

    def keep(name, out):
        def check(done):
            if done.returncode not in (0, 3):
                raise SystemExit(f"{name}: {done.stderr}")
            with open(table, "a") as file:
                file.write(f"{name}\t{digest_of(out)}\n")
            shutil.rmtree(out)
        return check

    commands = []
    for path in paths:
        name = str(path.relative_to(bench.work))
        out = bench.work / "alone" / path.parent.name
        if name not in known:
            shutil.rmtree(out, ignore_errors=True)
            commands.append(([bench.program, "ventricle", str(path), "--out", str(out), "--quiet", "--no-timings", "--threads", "1", *QUICK],
                             keep(name, out)))
    lanes(commands)
    return {bench.work / row["path"]: row["digest"] for row in rows_of(table)}


def look(cohort, seen):
    """At any moment every whole row tells the truth: what is done has its result."""
    for row in rows_of(cohort / "status.tsv")[seen:]:
        if None in row.values():  # the last row, while it is written
            break
        seen += 1
        if row["state"] == "done" and not (result_of(cohort, row["id"]) / "results.json").is_file():
            raise SystemExit(f"{row['id']} is done and has no result")
    return seen


def run_with_kills(bench, kinds, kills):
    """Two workers on one cohort; at random moments one of them is killed, and another takes its place."""
    cohort, killed_file, chance = bench.work / "cohort", bench.work / "kills.txt", random.Random(24)
    faults = ",".join(f"{name}={FAULTS[kind]}" for name, kind in kinds.items() if kind in FAULTS)
    words = [bench.program, "batch", str(bench.work / "studies.tsv"), "--out", str(cohort), "--jobs", "1", "--time-limit", "60",
             "--memory-limit", "600M", "--quiet", "--no-collect", "--", *QUICK]

    def start():
        return subprocess.Popen(words, env={**os.environ, "DYNASURF_DEBUG_FAULTS": faults}, stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)

    done = int(killed_file.read_text()) if killed_file.exists() else 0
    workers, seen, begin = [start(), start()], 0, time.monotonic()
    while any(worker.poll() is None for worker in workers):
        time.sleep(chance.uniform(0.1, 4))
        victim = chance.randrange(2)
        if done < kills and workers[victim].poll() is None:
            workers[victim].kill()
            workers[victim].wait()
            done += 1
            killed_file.write_text(str(done))
            seen = look(cohort, seen)
            workers[victim] = start()
    return done, time.monotonic() - begin, [worker.returncode for worker in workers]


def is_told(row, kind):
    """Whether the row of a spoiled study says what is wrong with it."""
    if kind == "no-heart":
        return row["state"] == "done" and row["verdict"] in ("check", "fail")
    return row["state"] == "failed" and KINDS[kind] in row["reason"] and row["reason"] != ""


def spoiled(bench, count, kills, every):
    rows = make_studies(bench, count)
    studies, kinds = spoil(bench, rows, every)
    good = {name: path for name, path in studies.items() if name not in kinds}
    killed, seconds, codes = run_with_kills(bench, kinds, kills)
    alone = run_alone(bench, sorted(set(good.values())))
    cohort = bench.work / "cohort"
    status = rows_of(cohort / "status.tsv")
    last = {row["id"]: row for row in status}
    same = sum(alone[path] == digest_of(result_of(cohort, name)) for name, path in good.items())
    bench.say(f"studies {count}, of them spoiled {len(kinds)}; workers killed {killed}; {seconds:.0f} s; last exit codes {sorted(codes)}")
    bench.say(f"good: done {sum(last[name]['state'] == 'done' for name in good)} of {len(good)}, bytes of a single run {same}")
    bench.say(f"rows {len(status)}, ids {len(last)}, left half-written {len(list(cohort.rglob('*.partial-*')))}")
    told = 0
    for kind in KINDS:
        its = [last[name] for name, what in kinds.items() if what == kind]
        told += sum(is_told(row, kind) for row in its)
        bench.say(f"  {kind} {len(its)}: told {sum(is_told(row, kind) for row in its)}; "
                  + "; ".join(sorted({row["reason"].replace(str(bench.work), "") or f"verdict {row['verdict']}" for row in its})))
    begin = time.monotonic()
    bench.must("collect", cohort, "--out", cohort / "tables", "--quiet")
    tables = rows_of(cohort / "tables" / "studies.tsv")
    bench.say(f"collect {time.monotonic() - begin:.1f} s: {len(tables)} rows")
    if not (killed >= kills and same == len(good) and told == len(kinds) and len(status) == len(last) == len(tables) == count):
        raise SystemExit("something was lost")
