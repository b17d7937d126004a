"""Cohorts on the engines that people run: the same bytes as one by one, by GNU parallel, Slurm and Snakemake."""

import os
import pathlib
import shutil
import subprocess
import unittest

from cli import PROGRAM, hashes, run
from test_batch import QUICK, BatchTest, patients, result_of, rows_of, serial, status_of
from studies import empty_study

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
    def test_runs_an_array_on_two_nodes_and_finishes_what_a_dead_node_leaves(self):
        cohort, folder = self.folder / "cohort", self.folder / "slurm"
        folder.mkdir()
        studies = int(os.environ.get("DYNASURF_SLURM_STUDIES", "1000"))
        empty_study(self.folder / "nothing.nii", (8, 8, 6, 2))
        table, nothings = self.table_of(studies)
        tasks = min(50, studies // 10)
        # Once a study is done, node2 dies with all that runs there. Its tasks are requeued: Slurm notices
        # the death, and makes them wait two minutes unless it is told not to.
        script = f"""set -eu
cd {folder}
job=$(sbatch --parsable --array=1-{tasks} {EXAMPLES}/slurm/cohort.sbatch {table} {cohort} {' '.join(QUICK)})
node2=$(pgrep -P $(cat node2.init))
until grep -qs done {cohort}/status.tsv && pgrep --ns $node2 --nslist pid -f 'dynasurf batch' >tasks; do
  test $SECONDS -lt 240 || {{ echo node2 runs nothing; squeue; exit 9; }}
  sleep 0.02
done
kill -9 $node2
echo killed with node2: $(wc -l <tasks)
while squeue -h -j $job 2>/dev/null | grep -q .; do scontrol update jobid=$job starttime=now 2>/dev/null || true; sleep 0.5; done
grep -h -o 'requeue.*' ctld.log | sort -u
{PROGRAM} collect {cohort} --out {cohort}/tables --quiet
"""
        done = subprocess.run(["unshare", "-n", "-m", pathlib.Path(__file__).with_name("slurm_cluster.sh"), folder, "bash", "-c", script],
                              env=ENVIRONMENT, capture_output=True, text=True, timeout=900)
        if done.returncode == 77:
            self.skipTest("Slurm did not come up in a network of its own")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, "killed with node2: [1-9]")
        self.assertIn("due to failure of node node2", done.stdout)
        status = rows_of(cohort / "status.tsv")
        self.assertEqual(len(status), studies)
        self.assertEqual(len({row["id"] for row in status}), studies)
        self.assertEqual({row["state"] for row in status}, {"done"})
        self.equals_serial(cohort)
        alone = self.folder / "alone"
        self.assertEqual(run("ventricle", self.folder / "nothing.nii", "--out", alone, "--quiet", "--no-timings", *QUICK).returncode, 3)
        for name in nothings:
            self.assertEqual(hashes(result_of(cohort, name)), hashes(alone), name)
        self.assertEqual(len(rows_of(cohort / "tables" / "studies.tsv")), studies)

    def snakemake_with(self, *profile):
        """The shards of Snakemake as jobs of Slurm, which keeps no accounts here."""
        serial()
        cohort, folder = self.folder / "cohort", self.folder / "slurm"
        folder.mkdir()
        words = ["snakemake", "--snakefile", EXAMPLES / "snakemake" / "Snakefile", *profile, "--jobs", "4",
                 "--latency-wait", "30", "--config", f"studies={patients() / 'patients.tsv'}", f"cohort={cohort}", "shards=3",
                 f"program={PROGRAM}", f"options={' '.join(QUICK)}"]
        done = subprocess.run(["unshare", "-n", "-m", pathlib.Path(__file__).with_name("slurm_cluster.sh"), folder, *words],
                              cwd=folder, env={**ENVIRONMENT, "USER": "root"}, capture_output=True, text=True, timeout=600)
        if done.returncode == 77:
            self.skipTest("Slurm did not come up in a network of its own")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual((folder / "ctld.log").read_text().count("sched: Allocate"), 4, "three shards and the tables are jobs")
        self.is_whole(cohort)

    @unittest.skipUnless(shutil.which("snakemake"), "Snakemake is not installed (snakemake)")
    def test_runs_the_shards_of_snakemake(self):
        self.snakemake_with("--slurm", "--max-status-checks-per-second", "1")

    @unittest.skipUnless(shutil.which("snakemake"), "Snakemake is not installed (snakemake)")
    def test_runs_the_shards_of_snakemake_by_a_command(self):
        self.snakemake_with("--cluster", "sbatch --cpus-per-task={threads} --mem={resources.mem_mb}")

    def table_of(self, studies):
        """Every patient, and images of nothing between them."""
        hearts = {row["id"]: patients() / row["path"] for row in rows_of(patients() / "patients.tsv")}
        nothings = [f"nothing-{n:04d}" for n in range(studies - len(hearts))]
        return self.table({**hearts, **{name: self.folder / "nothing.nii" for name in nothings}}), nothings


if __name__ == "__main__":
    unittest.main()
