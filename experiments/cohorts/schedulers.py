"""What a task costs on each engine: shards of a cohort that is done, so that nothing but the engine is paid for."""

import os
import shutil
import subprocess
import time

from cohort import QUICK, ROOT, nifti, write_table

TASKS = 10
EXAMPLES = ROOT / "examples"


def seconds_of(words, **options):
    begin = time.monotonic()
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, stdin=subprocess.DEVNULL, **options)
    if done.returncode != 0:
        raise SystemExit(f"{words[0]}: {done.stdout[-500:]}{done.stderr[-1000:]}")
    return time.monotonic() - begin, done.stdout


def by_slurm(bench, table, cohort, tasks):
    """Seconds from handing in an array to its end, in a Slurm of this machine."""
    folder = bench.work / "schedulers" / "slurm"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    script = (f"cd {folder}; begin=$(date +%s.%N); sbatch --wait --array=1-{tasks} {EXAMPLES}/slurm/cohort.sbatch {table} {cohort} "
              f"{' '.join(QUICK)} >/dev/null; echo $(date +%s.%N) $begin")
    _, out = seconds_of(["unshare", "-n", "-m", ROOT / "tests" / "cli" / "slurm_cluster.sh", folder, "bash", "-c", script],
                        env={**os.environ, "DYNASURF": bench.program})
    end, begin = map(float, out.split())
    return end - begin


def engines(bench, table, cohort):
    """Name of each engine, and the seconds that it takes for so many tasks."""
    snakemake = ["snakemake", "--snakefile", EXAMPLES / "snakemake" / "Snakefile", "--cores", "2", "--forceall", "--config",
                 f"studies={table}", f"cohort={cohort}", f"program={bench.program}", f"options={' '.join(QUICK)}"]
    environment = {**os.environ, "DYNASURF": bench.program}
    shard = lambda n, tasks: [bench.program, "batch", table, "--out", cohort, "--shard", f"{n}/{tasks}", "--quiet", "--no-collect", "--", *QUICK]
    return {
        "bare": lambda tasks: sum(seconds_of(shard(n + 1, tasks))[0] for n in range(tasks)),
        "GNU parallel": lambda tasks: seconds_of([EXAMPLES / "parallel" / "run.sh", table, cohort, tasks, *QUICK], env=environment)[0],
        "Snakemake": lambda tasks: seconds_of([*snakemake, f"shards={tasks}"], cwd=bench.work / "schedulers")[0],
        "Slurm": lambda tasks: by_slurm(bench, table, cohort, tasks),
    }


def schedulers(bench):
    folder = bench.work / "schedulers"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "nothing.nii").write_bytes(nifti(0.0))
    write_table(folder / "studies.tsv", ("id", "path"), [(f"s{n}", "nothing.nii") for n in range(TASKS)])
    cohort = folder / "cohort"
    bench.must("batch", folder / "studies.tsv", "--out", cohort, "--quiet", "--", *QUICK)
    for name, run in engines(bench, folder / "studies.tsv", cohort).items():
        one, all_tasks = (min(run(tasks) for _ in range(3)) for tasks in (1, TASKS))
        bench.say(f"{name}: 1 task {one:.2f} s, {TASKS} tasks {all_tasks:.2f} s: {(all_tasks - one) / (TASKS - 1):.3f} s a task")
