"""Studies a minute of a batch on two processors, beside the bare program on the same studies, in turns."""

import shutil
import statistics
import time

from cohort import lanes, rows_of

PER_ROUND = 12


def rate(bench, rounds):
    # The studies of `phantom patients --small` with the whole fit: about a second each.
    folder = bench.work / "rate"
    table = folder / "patients" / "patients.tsv"
    if not table.exists():
        bench.must("phantom", "patients", "--count", PER_ROUND, "--small", "--seed", "3", "--out", table.parent, "--quiet", "--set", "gates=2")
    paths = {row["id"]: table.parent / row["path"] for row in rows_of(table)}

    def expect_result(done):
        if done.returncode not in (0, 3):
            raise SystemExit(done.stderr)

    seconds = {"bare": [], "batch": []}
    for _ in range(rounds):
        for kind in seconds:
            out = folder / kind
            shutil.rmtree(out, ignore_errors=True)
            if kind == "bare":
                commands = [([bench.program, "ventricle", str(path), "--out", str(out / name), "--quiet", "--no-timings", "--threads", "1"],
                             expect_result) for name, path in paths.items()]
            else:
                commands = [([bench.program, "batch", str(table), "--out", str(out), "--jobs", "2", "--quiet", "--no-collect"], expect_result)]
            seconds[kind].append(lanes(commands))
    for kind, runs in seconds.items():
        wall = [run[0] for run in runs]
        bench.say(f"{kind}: {PER_ROUND} studies in {', '.join(f'{s:.1f}' for s in wall)} s; {60 * PER_ROUND / min(wall):.0f} studies a minute "
                  f"at best, {60 * PER_ROUND / statistics.median(wall):.0f} in the middle; {statistics.median(r[1] for r in runs) / PER_ROUND:.3f} processor seconds a study")
    walls = [[run[0] for run in seconds[kind]] for kind in ("bare", "batch")]
    cpus = [[run[1] for run in seconds[kind]] for kind in ("bare", "batch")]
    bench.say(f"cost of the batch: wall {100 * (min(walls[1]) / min(walls[0]) - 1):+.1f} % of the best runs, "
              f"processor {100 * (statistics.median(cpus[1]) / statistics.median(cpus[0]) - 1):+.1f} % in the middle")
