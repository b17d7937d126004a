#!/usr/bin/env python3
"""Benchmarks of cohorts: run.py PROGRAM WORK [spoiled|rate|many|schedulers]. What was made in WORK is not made again, so that
an interrupted run goes on. The results of each go to results-*.txt beside this file."""

import argparse
import pathlib

from cohort import Bench
from many import many
from rate import rate
from schedulers import schedulers
from spoiled import spoiled

HERE = pathlib.Path(__file__).resolve().parent


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("program", help="the program dynasurf")
    arguments.add_argument("work", help="folder of everything that is made")
    arguments.add_argument("which", choices=("spoiled", "rate", "many", "schedulers"))
    arguments.add_argument("--studies", type=int, default=2000)
    arguments.add_argument("--kills", type=int, default=200)
    arguments.add_argument("--spoil-every", type=int, default=100, help="one study of so many is spoiled")
    arguments.add_argument("--many", type=int, nargs="+", default=[1000, 10000], help="how many studies stand in one folder")
    arguments.add_argument("--rounds", type=int, default=3)
    given = arguments.parse_args()
    bench = Bench(given.program, given.work)
    if given.which == "spoiled":
        spoiled(bench, given.studies, given.kills, given.spoil_every)
    elif given.which == "rate":
        rate(bench, given.rounds)
    elif given.which == "many":
        many(bench, given.many)
    else:
        schedulers(bench, given.rounds)
    (HERE / f"results-{given.which}.txt").write_text("\n".join(bench.lines) + "\n")


if __name__ == "__main__":
    main()
