"""What a task costs on each engine: shards of a cohort that is done, so that nothing but the engine is paid for."""

import os
import shutil
import subprocess
import time

from cohort import QUICK, ROOT, nifti, write_table

FEW, MANY, ROUNDS = 10, 60, 3
EXAMPLES = ROOT / "examples"

# Slurm's own end of an array: `sbatch --wait` would look every ten seconds at best, and accounts count whole seconds.
ARRAY = """
round() {
  begin=$(date +%s.%N)
  job=$(sbatch --parsable --output=/dev/null --array=1-$1 "${@:2}")
  while test -n "$(squeue --noheader --jobs="$job" 2>/dev/null)"; do sleep 0.05; done
  echo "$1 $begin $(date +%s.%N)"
}
"""


def seconds_of(words, **options):
    begin = time.monotonic()
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, stdin=subprocess.DEVNULL, **options)
    if done.returncode != 0:
        raise SystemExit(f"{words[0]}: {done.stdout[-500:]}{done.stderr[-1000:]}")
    return time.monotonic() - begin, done.stdout


def by_slurm(bench, table, cohort):
    """Seconds from handing in an array to its end, in a Slurm of this machine: {tasks: one of each round}."""
    folder = bench.work / "schedulers" / "slurm"
    folder.mkdir()
    words = f"{EXAMPLES}/slurm/cohort.sbatch {table} {cohort} {' '.join(QUICK)}"
    script = f"cd {folder}{ARRAY}" + "".join(f"round {tasks} {words}\n" for _ in range(ROUNDS) for tasks in (1, FEW, MANY))
    _, out = seconds_of(["unshare", "-n", "-m", ROOT / "tests" / "cli" / "slurm_cluster.sh", folder, "bash", "-c", script],
                        env={**os.environ, "DYNASURF": bench.program})
    seconds = {}
    for line in out.splitlines():
        tasks, begin, end = line.split()
        seconds.setdefault(int(tasks), []).append(float(end) - float(begin))
    return seconds


def engines(bench, table, cohort):
    """Name of each engine, and the seconds of each round for so many tasks."""
    snakemake = ["snakemake", "--snakefile", EXAMPLES / "snakemake" / "Snakefile", "--cores", "2", "--forceall", "--config",
                 f"studies={table}", f"cohort={cohort}", f"program={bench.program}", f"options={' '.join(QUICK)}"]
    environment = {**os.environ, "DYNASURF": bench.program}
    shard = lambda n, tasks: [bench.program, "batch", table, "--out", cohort, "--shard", f"{n}/{tasks}", "--quiet", "--no-collect", "--", *QUICK]
    rounds = lambda run: {tasks: [run(tasks) for _ in range(ROUNDS)] for tasks in (1, FEW, MANY)}
    return {
        "bare, one after the other": lambda: rounds(lambda tasks: sum(seconds_of(shard(n + 1, tasks))[0] for n in range(tasks))),
        "GNU parallel": lambda: rounds(lambda tasks: seconds_of([EXAMPLES / "parallel" / "run.sh", table, cohort, tasks, *QUICK], env=environment)[0]),
        "Snakemake": lambda: rounds(lambda tasks: seconds_of([*snakemake, f"shards={tasks}"], cwd=bench.work / "schedulers")[0]),
        "Slurm": lambda: by_slurm(bench, table, cohort),
    }


def schedulers(bench):
    folder = bench.work / "schedulers"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "nothing.nii").write_bytes(nifti(0.0))
    write_table(folder / "studies.tsv", ("id", "path"), [(f"s{n}", "nothing.nii") for n in range(MANY)])
    cohort = folder / "cohort"
    bench.must("batch", folder / "studies.tsv", "--out", cohort, "--quiet", "--", *QUICK)
    for name, run in engines(bench, folder / "studies.tsv", cohort).items():
        best = {tasks: min(seconds) for tasks, seconds in run().items()}
        bench.say(f"{name}: " + ", ".join(f"{tasks} task{'s' * (tasks > 1)} {seconds:.2f} s" for tasks, seconds in best.items())
                  + f": {(best[MANY] - best[FEW]) / (MANY - FEW):.3f} s a task")
