"""What a task costs on each engine: shards of a cohort that is done, so that nothing but the engine is paid for."""

import os
import shutil
import subprocess
import time

from cohort import QUICK, ROOT, nifti, write_table

FEW, MANY = 5, 40
EXAMPLES = ROOT / "examples"

# Slurm's own word that a task is over: `sbatch --wait` looks every ten seconds at best, and squeue costs what it measures.
ARRAY = """
over() { grep -c '_job_complete: .* done' ctld.log || true; }
before=$(over)
sbatch --parsable --output=/dev/null --array=1-$1 "${@:2}" >job
until test $(over) -ge $((before + $1)); do sleep 0.2; done
"""


def cost_of(words, **options):
    """Seconds that a command takes, and processor seconds of all that it starts: the first process of a namespace
    inherits what loses its parent, and all ends with it."""
    before, begin = os.times(), time.monotonic()
    done = subprocess.run(["unshare", "--pid", "--fork", "--mount-proc", *map(str, words)], capture_output=True, text=True,
                          stdin=subprocess.DEVNULL, **options)
    if done.returncode != 0:
        raise SystemExit(f"{words[0]}: {done.stdout[-500:]}{done.stderr[-1000:]}")
    after = os.times()
    return time.monotonic() - begin, after.children_user + after.children_system - before.children_user - before.children_system


def by_slurm(bench, table, cohort, tasks):
    """The cost of an array of tasks in a Slurm of this machine, with that of its daemons."""
    folder = bench.work / "schedulers" / "slurm"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    return cost_of(["unshare", "-n", "-m", ROOT / "tests" / "cli" / "slurm_cluster.sh", folder, "bash", "-c", f"set -e; cd {folder}{ARRAY}", "array",
                    tasks, f"{EXAMPLES}/slurm/cohort.sbatch", table, cohort, *QUICK], env={**os.environ, "DYNASURF": bench.program})


def engines(bench, table, cohort):
    """Name of each engine, and the cost of so many tasks."""
    snakemake = ["snakemake", "--snakefile", EXAMPLES / "snakemake" / "Snakefile", "--cores", "2", "--forceall", "--config",
                 f"studies={table}", f"cohort={cohort}", f"program={bench.program}", f"options={' '.join(QUICK)}"]
    environment = {**os.environ, "DYNASURF": bench.program}
    one_by_one = f'for n in $(seq $1); do {bench.program} batch {table} --out {cohort} --shard $n/$1 --quiet --no-collect -- {" ".join(QUICK)}; done'
    return {
        "none": lambda tasks: cost_of(["bash", "-c", one_by_one, "tasks", tasks]),
        "GNU parallel": lambda tasks: cost_of([EXAMPLES / "parallel" / "run.sh", table, cohort, tasks, *QUICK], env=environment),
        "Snakemake": lambda tasks: cost_of([*snakemake, f"shards={tasks}"], cwd=bench.work / "schedulers"),
        "Slurm": lambda tasks: by_slurm(bench, table, cohort, tasks),
    }


def schedulers(bench, rounds):
    folder = bench.work / "schedulers"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "nothing.nii").write_bytes(nifti(0.0))
    write_table(folder / "studies.tsv", ("id", "path"), [(f"s{n}", "nothing.nii") for n in range(MANY)])
    cohort = folder / "cohort"
    bench.must("batch", folder / "studies.tsv", "--out", cohort, "--quiet", "--", *QUICK)
    for name, run in engines(bench, folder / "studies.tsv", cohort).items():
        few, many = ([run(tasks) for _ in range(rounds)] for tasks in (FEW, MANY))
        (wall, cpu), (walls, cpus) = ([min(kind) for kind in zip(*costs)] for costs in (few, many))
        bench.say(f"{name}: {FEW} tasks {wall:.2f} s, {MANY} tasks {walls:.2f} s; a task {(walls - wall) / (MANY - FEW):.3f} s, "
                  f"of a processor {(cpus - cpu) / (MANY - FEW):.3f} s")
