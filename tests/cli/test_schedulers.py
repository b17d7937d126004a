"""Cohorts on the engines that people run: the same bytes as one by one, by GNU parallel, Slurm and Snakemake."""

import os
import pathlib
import shutil
import subprocess
import unittest

from cli import PROGRAM
from test_batch import QUICK, BatchTest, patients, rows_of, serial, status_of

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
ENVIRONMENT = {**os.environ, "DYNASURF": PROGRAM}


class Scheduled(BatchTest):
    def is_whole(self, cohort):
        self.assertEqual({row["state"] for row in status_of(cohort).values()}, {"done"})
        names = [row["id"] for row in rows_of(cohort / "status.tsv")]
        self.assertEqual(sorted(names), sorted(serial()))
        self.equals_serial(cohort)
        self.assertTrue((cohort / "tables" / "cohort.html").is_file())


@unittest.skipUnless(shutil.which("parallel"), "GNU parallel is not installed (parallel)")
class Parallel(Scheduled):
    def test_runs_shards(self):
        cohort = self.folder / "cohort"
        done = subprocess.run([EXAMPLES / "parallel" / "run.sh", patients() / "patients.tsv", cohort, "3", *QUICK],
                              env=ENVIRONMENT, capture_output=True, text=True, timeout=500)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.is_whole(cohort)


@unittest.skipUnless(shutil.which("snakemake"), "Snakemake is not installed (snakemake)")
class Snakemake(Scheduled):
    def test_runs_shards(self):
        cohort = self.folder / "cohort"
        done = subprocess.run(["snakemake", "--snakefile", EXAMPLES / "snakemake" / "Snakefile", "--cores", "2", "--config",
                               f"studies={patients() / 'patients.tsv'}", f"cohort={cohort}", "shards=3",
                               f"program={PROGRAM}", f"options={' '.join(QUICK)}"],
                              cwd=self.folder, env=ENVIRONMENT, capture_output=True, text=True, timeout=500)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.is_whole(cohort)


@unittest.skipUnless(shutil.which("slurmctld") and shutil.which("munged") and os.geteuid() == 0,
                     "Slurm is not installed (slurmctld, slurmd, slurm-client, munge), or the test does not run as root")
class Slurm(Scheduled):
    def test_runs_an_array_and_finishes_what_was_killed(self):
        cohort, folder = self.folder / "cohort", self.folder / "slurm"
        folder.mkdir()
        serial()
        # One shard is killed and requeued as soon as a study is done; the array is waited for, then collected.
        script = f"""set -eu
cd {folder}
job=$(sbatch --parsable --array=1-3 {EXAMPLES}/slurm/cohort.sbatch {patients()}/patients.tsv {cohort} {' '.join(QUICK)})
while ! grep -q done {cohort}/status.tsv 2>/dev/null; do sleep 0.1; done
task=$(squeue -h -t R -o %A -j $job | head -1)
if test -n "$task"; then scontrol requeue $task && echo requeued; fi
# Slurm makes a requeued task wait two minutes, unless it is told not to.
while squeue -h -j $job 2>/dev/null | grep -q .; do scontrol update jobid=$task starttime=now 2>/dev/null || true; sleep 0.5; done
{PROGRAM} collect {cohort} --out {cohort}/tables --quiet
"""
        done = subprocess.run(["unshare", "-n", "-m", pathlib.Path(__file__).with_name("slurm_cluster.sh"), folder, "bash", "-c", script],
                              env=ENVIRONMENT, capture_output=True, text=True, timeout=500)
        if done.returncode == 77:
            self.skipTest("Slurm did not come up in a network of its own")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("requeued", done.stdout)
        self.is_whole(cohort)


if __name__ == "__main__":
    unittest.main()
