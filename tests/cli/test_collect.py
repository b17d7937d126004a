"""What is made of many results: tables, statistics, a page, comparisons, normal limits."""

import functools
import json
import pathlib
import shutil
import sqlite3
import subprocess
import unittest

try:
    import numpy
    from scipy import stats
except ImportError:
    stats = None

from cli import PROGRAM, run, shared_folder
from test_batch import QUICK, STUDIES, BatchTest, patients, result_of, rows_of, serial


class Collect(BatchTest):
    @functools.cached_property
    def cohort(self):
        cohort = shared_folder() / "collected"
        if not cohort.exists():
            done = self.batch(patients() / "patients.tsv", "--out", cohort, "--quiet", "--", *QUICK)
            self.assertEqual(done.returncode, 0, done.stderr)
        return cohort

    def test_tables_hold_the_numbers_of_the_results(self):
        tables = self.cohort / "tables"
        studies = rows_of(tables / "studies.tsv")
        self.assertEqual([row["id"] for row in studies], [row["id"] for row in rows_of(patients() / "patients.tsv")])
        for row in studies:
            result = self.read_json(result_of(self.cohort, row["id"]) / "results.json")
            self.assertEqual(float(row["ef_percent"]), result["ef_percent"])
            self.assertEqual(float(row["readings_edge_edv_ml"]), result["readings"]["edge"]["edv_ml"])
            self.assertEqual(row["verdict"], result["quality"]["verdict"])
            self.assertTrue((tables / row["report"]).resolve().is_file())
        segments = rows_of(tables / "segments.tsv")
        self.assertEqual(len(segments), 17 * len(studies))
        self.assertEqual(len(rows_of(tables / "curves.tsv")), 2 * len(studies))
        described = {(row["table"], row["column"]) for row in rows_of(tables / "dictionary.tsv")}
        for name in ("studies", "segments", "curves"):
            for column in rows_of(tables / f"{name}.tsv")[0]:
                self.assertIn((name, column), described)

    def test_sqlite_holds_the_same(self):
        tables = self.cohort / "tables"
        with sqlite3.connect(f"file:{tables / 'cohort.sqlite'}?mode=ro", uri=True) as database:
            for name in ("studies", "segments", "curves", "dictionary"):
                rows = rows_of(tables / f"{name}.tsv")
                cursor = database.execute(f"select * from {name}")
                self.assertEqual([column[0] for column in cursor.description], list(rows[0]))
                self.assertEqual(len(cursor.fetchall()), len(rows))
            ef = [row[0] for row in database.execute("select ef_percent from studies order by rowid")]
            self.assertEqual(ef, [float(row["ef_percent"]) for row in rows_of(tables / "studies.tsv")])
            self.assertEqual(database.execute("pragma integrity_check").fetchone()[0], "ok")
        database.close()

    def test_statistics_are_of_the_trustworthy_studies(self):
        studies = rows_of(self.cohort / "tables" / "studies.tsv")
        values = [float(row["ef_percent"]) for row in studies if row["verdict"] != "fail"]
        mean = next(row for row in rows_of(self.cohort / "tables" / "statistics.tsv")
                    if (row["statistic"], row["of"], row["group"]) == ("mean", "ef_percent", ""))
        self.assertEqual(int(mean["n"]), len(values))
        self.assertEqual(int(mean["left_out"]), len(studies) - len(values))
        self.assertAlmostEqual(float(mean["value"]), sum(values) / len(values), places=9)

    def statistic(self, *key):
        """Value and interval of a row by statistic, of, against and group."""
        return next([float(row[c]) if row[c] else None for c in ("value", "low_95", "high_95")]
                    for row in rows_of(self.cohort / "tables" / "statistics.tsv")
                    if (row["statistic"], row["of"], row["against"], row["group"]) == key)

    def agree(self, ours, theirs):
        for a, b in zip(ours, theirs, strict=True):
            self.assertAlmostEqual(a, b, delta=1e-8 * max(1, abs(b)))

    def test_outcomes_have_intervals(self):
        outcomes = {row["of"]: row for row in rows_of(self.cohort / "tables" / "statistics.tsv")
                    if row["statistic"] == "share" and row["group"] == ""}
        self.assertEqual(set(outcomes), {"verdict=ok", "verdict=check", "verdict=fail", "verdict=no result"})
        self.assertAlmostEqual(sum(float(row["value"]) for row in outcomes.values()), 1, 12)
        for row in outcomes.values():
            self.assertTrue(0 <= float(row["low_95"]) <= float(row["value"]) <= float(row["high_95"]) <= 1, row)
            self.assertLess(float(row["low_95"]), float(row["high_95"]))

    @unittest.skipIf(stats is None, "SciPy is not installed (python3-scipy)")
    def test_statistics_are_those_of_scipy(self):
        rows = [row for row in rows_of(self.cohort / "tables" / "studies.tsv") if row["verdict"] != "fail"]
        ef = [float(row["ef_percent"]) for row in rows]
        self.agree(self.statistic("mean", "ef_percent", "", ""),
                   [numpy.mean(ef), *stats.t.interval(0.95, len(ef) - 1, numpy.mean(ef), stats.sem(ef))])
        truth = numpy.array([float(row["ef_true_percent"]) for row in rows])
        differences = ef - truth
        n, bias, sd = len(ef), differences.mean(), differences.std(ddof=1)
        half = stats.t.ppf(0.975, n - 1) * sd * (1 / n + 1.96**2 / (2 * (n - 1))) ** 0.5
        high = bias + 1.96 * sd
        self.agree(self.statistic("limit_high", "ef_percent", "ef_true_percent", ""), [high, high - half, high + half])
        both = numpy.stack([truth, ef], axis=1)
        ms_cases = 2 * both.mean(axis=1).var(ddof=1)
        ms_readers = n * both.mean(axis=0).var(ddof=1)
        ms_error = (both.var(ddof=1) * (2 * n - 1) - ms_cases * (n - 1) - ms_readers) / (n - 1)
        icc = (ms_cases - ms_error) / (ms_cases + ms_error + 2 * (ms_readers - ms_error) / n)
        self.agree(self.statistic("icc_absolute", "ef_percent", "ef_true_percent", "")[:1], [icc])
        by_subject = {}
        for row in rows:
            by_subject.setdefault(row["subject"], []).append(float(row["edv_ml"]))
        repeats = [v for v in by_subject.values() if len(v) > 1]
        if repeats:
            squares, degrees = sum(numpy.var(v) * len(v) for v in repeats), sum(len(v) - 1 for v in repeats)
            self.agree(self.statistic("within_subject_sd", "edv_ml", "", ""),
                       [(squares / d) ** 0.5 for d in (degrees, stats.chi2.ppf(0.975, degrees), stats.chi2.ppf(0.025, degrees))])
        groups = {}
        for row in rows:
            groups.setdefault(row["site"], []).append(float(row["ef_percent"]))
        if sorted(map(len, groups.values()))[0] > 1 and len(groups) == 2:
            p = stats.ttest_ind(groups["A"], groups["B"], equal_var=False).pvalue
            self.agree(self.statistic("welch_p", "ef_percent", "", "site=A less B")[:1], [p])

    def test_a_reader_s_decision_stands_in_the_tables_and_on_the_page(self):
        said = self.folder / "options.json"
        said.write_text(json.dumps({"manual": {"decision": "rejected", "reader": "A. Reader", "comment": "apex\tcut </script>"}}))
        words = {"no": f"--options {said}", "yes": "--set manual.decision=accepted", "seen": "--set manual.comment=dim", "open": ""}
        study = patients() / rows_of(patients() / "patients.tsv")[0]["path"]
        table = self.folder / "studies.tsv"
        table.write_text("id\tpath\toptions\n" + "".join(f"{name}\t{study}\t{more}\n" for name, more in words.items()))
        done = self.batch(table, "--out", self.folder / "read", "--quiet", "--", *QUICK)
        self.assertEqual(done.returncode, 0, done.stderr)
        tables = self.folder / "read" / "tables"
        columns = ["manual_decision", "manual_reader", "manual_comment"]
        expected = {"no": ["rejected", "A. Reader", "apex cut </script>"], "yes": ["accepted", "", ""], "seen": ["", "", "dim"], "open": ["", "", ""]}
        self.assertEqual({row["id"]: [row[key] for key in columns] for row in rows_of(tables / "studies.tsv")}, expected)
        page = (tables / "cohort.html").read_text(encoding="utf-8")
        studies = json.loads(page.split('id="data">')[1].split("</script>")[0])["studies"]
        made = {study["id"]: study.get("manual") for study in studies}
        self.assertEqual(made, {"no": {"decision": "rejected", "reader": "A. Reader", "comment": "apex\tcut </script>"},
                                "yes": {"decision": "accepted", "reader": "", "comment": ""},
                                "seen": {"decision": "", "reader": "", "comment": "dim"}, "open": None})

    def test_page_opens_studies_in_the_program_where_live_pages_were_asked_for(self):
        program, page = (self.folder / "installed" / place for place in ("bin/dynasurf", "share/dynasurf/dynasurf.html"))
        for file in (program, page):
            file.parent.mkdir(parents=True)
        shutil.copy(PROGRAM, program)
        page.write_text('<script id="given"></script>')
        study = patients() / rows_of(patients() / "patients.tsv")[0]["path"]
        table = self.folder / "studies.tsv"
        for name, live in (("live", ["--live"]), ("report", [])):
            table.write_text(f"id\tpath\n{name}\t{study}\n")
            words = [program, "batch", table, "--out", self.folder / name, "--quiet", "--", *QUICK, *live]
            self.assertEqual(subprocess.run(words).returncode, 0)
            tables = self.folder / name / "tables"
            data = (tables / "cohort.html").read_text(encoding="utf-8").split('id="data">')[1].split("</script>")[0]
            link = tables / json.loads(data)["studies"][0]["report"]
            self.assertEqual((link.name, link.is_file()), (f"{name}.html", True))

    def test_page_works_in_a_browser(self):
        web = pathlib.Path(__file__).resolve().parents[2] / "web"
        node = shutil.which("node") or shutil.which("nodejs")
        if not node or not (web / "node_modules" / "playwright-core").is_dir():
            self.skipTest("Node.js and the packages of web/ are not there")
        done = subprocess.run([node, web / "test" / "cohort.test.mjs", self.cohort / "tables" / "cohort.html"],
                              capture_output=True, text=True, timeout=300)
        if done.returncode == 77:
            self.skipTest(done.stdout)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_compares_two_cohorts(self):
        other = self.folder / "other"
        self.assertEqual(self.batch(patients() / "patients.tsv", "--out", other, "--quiet", "--no-collect", "--", *QUICK, "--set", "edges.sigma_px=1.5").returncode, 0)
        done = run("collect", self.cohort, "--out", self.folder / "tables", "--compare", other)
        self.assertEqual(done.returncode, 0, done.stderr)
        changes = rows_of(self.folder / "tables" / "comparison.tsv")
        self.assertEqual(len(changes), STUDIES)
        self.assertIn("settings", {row["why"] for row in changes})
        shifts = [abs(float(row["ef_percent_change"])) for row in changes if row["ef_percent_change"]]
        self.assertEqual(shifts, sorted(shifts, reverse=True))
        same = run("collect", self.cohort, "--out", self.folder / "same", "--compare", self.cohort)
        self.assertEqual(same.returncode, 0, same.stderr)
        self.assertEqual({row["why"] for row in rows_of(self.folder / "same" / "comparison.tsv")}, {""})

    def test_refuses_a_folder_that_is_no_cohort(self):
        self.refuses(2, "collect", patients(), "--out", self.folder / "t", says="inputs.tsv")


class NormalLimits(BatchTest):
    def test_of_a_cohort_s_groups_are_used_by_scores(self):
        rows = rows_of(patients() / "patients.tsv")
        serial()
        verdicts = [self.read_json(shared_folder() / "serial" / row["id"] / "results.json")["quality"]["verdict"] for row in rows]
        trusted = [n for n, verdict in enumerate(verdicts) if verdict != "fail"]
        tracers = ["y" if n == trusted[-1] else "" if n == 0 and n not in trusted else "x" for n in range(STUDIES)]
        table = self.folder / "studies.tsv"
        table.write_text("id\tpath\ttracer\n" + "".join(f"{row['id']}\t{patients() / row['path']}\t{tracer}\n"
                                                        for row, tracer in zip(rows, tracers, strict=True)))
        cohort, out = self.folder / "cohort", self.folder / "normals.json"
        self.assertEqual(self.batch(table, "--out", cohort, "--no-collect", "--", *QUICK).returncode, 0)
        made = run("perfusion", "build", cohort, "--by", "tracer", "--least", 3, "--out", out)
        self.assertEqual(made.returncode, 0, made.stderr)
        normals = self.read_json(out)
        self.assertEqual(normals["all"]["studies"], len(trusted))
        of = {group["values"][0]: group for group in normals["groups"]}
        for tracer in "xy":
            count = sum(tracers[n] == tracer for n in trusted)
            self.assertEqual((of[tracer]["studies"], of[tracer]["map"] is not None), (count, tracer == "x"))
        self.assertNotIn("", of)
        result = result_of(cohort, rows[trusted[0]]["id"])
        for group, words in (("x", f"{of['x']['studies']} studies of tracer=x"),
                             ("y", f"all {len(trusted)} studies, for there are only 1 of tracer=y")):
            scored = run("perfusion", "score", result, "--normals", out, "--group", f"tracer={group}")
            self.assertIn(f"normals: {words}\n", scored.stdout, scored.stderr)
        self.refuses(2, "perfusion", "score", result, "--normals", out, "--group", "tracer=z", says="no group tracer=z; expected one of: tracer=x; tracer=y")
        self.refuses(1, "perfusion", "score", result, "--group", "tracer=x", says="--group belongs to --normals")
        self.refuses(1, "perfusion", "score", result, "--normals", out, "--group", "x", says="expected COLUMN=VALUE")
        self.refuses(1, "perfusion", "build", cohort, "--by", "sex", "--out", self.folder / "n", says="no column sex; expected one of: tracer")
        self.refuses(2, "perfusion", "build", cohort, "--where", "tracer=y", "--out", self.folder / "n", says="holds 1 results with polar maps; expected at least 3")
        self.refuses(1, "perfusion", "build", cohort / "studies", "--by", "tracer", "--out", self.folder / "n", says="is no cohort")


if __name__ == "__main__":
    unittest.main()
