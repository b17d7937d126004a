#!/usr/bin/env python3
"""Breaks the sources one operator at a time and tells which of the breaks the tests notice.

    tools/mutate.py --test test_field --count 20 --seed 1 src/dynasurf/field/gvf.cpp src/dynasurf/field/sample.cpp
    tools/mutate.py --test test_io --filter 'Manifest*:OutputFolder*' src/dynasurf/io/manifest.cpp

Works in a copy of the repository at --build, never in the working tree. A mutant is killed when the tests of the room
fail, crash or take ten times as long; it survives when they pass. Those that do not compile do not count. Some that
survive change nothing that anybody could see (a limit that is never met, an order of equal things); they stay in the list
for a reader to judge."""

import argparse
import collections
import dataclasses
import json
import pathlib
import random
import re
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
# Binary operators stand between blanks in formatted sources; so the signs of templates, pointers and references do not.
SWAPS = {"+": "-", "-": "+", "*": "/", "/": "*", "%": "*", "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=",
         "!=": "==", "&&": "||", "||": "&&", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=", "&": "|", "|": "&"}
OPERATOR = re.compile(r"(?<= )(" + "|".join(re.escape(word) for word in sorted(SWAPS, key=len, reverse=True)) + r")(?= |$)",
                      re.MULTILINE)
NUMBER = re.compile(r"(?<![\w.'])(\d+\.?\d*(?:e[-+]?\d+)?)(?=[uf]?\b)(?![\w.]*\")")
RETURN = re.compile(r"\breturn ([^;{}]+);")
NEGATION = re.compile(r"(?<=[( ])!(?=[\w(])")
STATEMENT = re.compile(r"^ +((?!return|throw|break|using|static|const|auto|case|else|for|if|while|default|namespace)"
                       r"[\w.\[\]()>-]+(?:(?: [-+*/]?=|\() ?.*|\+\+|--));$", re.MULTILINE)
# What no test of numbers or bytes can see: declarations, messages, promises that are only checked in debug builds.
UNSEEN = re.compile(r"^ *#.*$|\bstatic_assert\b[^;]*;|\bDYNASURF_ASSERT\b[^;]*;|\b(?:throw|fail|refuse)\b[^;]*;"
                    r"|\btemplate\s*<[^>]*>|\boperator\S+|\bcase [^:]*:", re.MULTILINE)
SILENT = re.compile(r'//[^\n]*|/\*.*?\*/|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.DOTALL)


@dataclasses.dataclass(frozen=True)
class Mutant:
    path: str
    line: int
    begin: int
    end: int
    text: str
    kind: str


def blanked(source):
    """The source with comments, texts and what no test can see as blanks; places stay where they are."""
    def blank(match):
        return re.sub(r"[^\n]", " ", match.group())
    return UNSEEN.sub(blank, SILENT.sub(blank, source))


def changed_number(word):
    if re.fullmatch(r"\d+", word):
        return str(int(word) + 1)
    return repr(float(word) + 1)


def sites(path, source):
    """All mutants of one source."""
    code = blanked(source)

    def mutant(begin, end, text, kind):
        return Mutant(path, code.count("\n", 0, begin) + 1, begin, end, text, kind)

    for found in OPERATOR.finditer(code):
        yield mutant(*found.span(), SWAPS[found[0]], f"{found[0]} to {SWAPS[found[0]]}")
    for found in NUMBER.finditer(code):
        yield mutant(*found.span(1), changed_number(found[1]), f"{found[1]} to {changed_number(found[1])}")
    for found in NEGATION.finditer(code):
        yield mutant(*found.span(), "", "! dropped")
    for found in RETURN.finditer(code):
        negated = {"true": "false", "false": "true"}.get(found[1])
        if negated is None and re.search(r" (?:<|>|<=|>=|==|!=|&&|\|\|) |^!", found[1]):
            negated = f"!({found[1]})"
        elif negated is None:
            negated = f"-({source[found.start(1):found.end(1)]})"
        yield mutant(*found.span(1), negated, "return negated")
    for found in STATEMENT.finditer(code):
        yield mutant(*found.span(1), "", "statement deleted")


def chosen(paths, count, seed, root=ROOT):
    """`count` mutants, drawn evenly over the kinds of changes and then over their places."""
    kinds = collections.defaultdict(list)
    for path in paths:
        for mutant in sites(path, (root / path).read_text()):
            kinds[re.sub(r"\d[\d.e+-]*", "n", mutant.kind)].append(mutant)
    rng = random.Random(seed)
    for of_kind in kinds.values():
        rng.shuffle(of_kind)
    found, order = [], sorted(kinds)
    while len(found) < count and any(kinds.values()):
        for kind in order:
            if kinds[kind] and len(found) < count:
                found.append(kinds[kind].pop())
    return found


class Workshop:
    """A copy of the sources with a build folder of its own."""

    def __init__(self, tree, test, options, only):
        # As in the repository, so that a cache of compilers knows all but the broken sources.
        self.tree, self.build, self.test = tree, tree / "build" / "release", test
        self.only = only
        listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=ROOT, check=True,
                                capture_output=True, text=True)
        for name in filter(None, listed.stdout.split("\0")):
            self.restore(name)
        subprocess.run(["cmake", "--preset", "release", *(f"-D{option}" for option in options)], cwd=self.tree, check=True,
                       stdout=subprocess.DEVNULL)
        if not self.compiles():
            sys.exit("the unbroken sources do not compile")
        begin = time.monotonic()
        if not self.passes(1800):
            sys.exit("the tests fail without a break")
        self.limit = max(20.0, 10 * (time.monotonic() - begin))

    def restore(self, name):
        source, copy = ROOT / name, self.tree / name
        if not source.is_file():
            return
        copy.parent.mkdir(parents=True, exist_ok=True)
        if not copy.exists() or copy.read_bytes() != source.read_bytes():
            shutil.copyfile(source, copy)

    def compiles(self):
        return subprocess.run(["cmake", "--build", self.build, "-j", "2", "--target", self.test],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode == 0

    def passes(self, limit):
        try:
            return subprocess.run([self.build / "bin" / self.test, "--gtest_fail_fast", "--gtest_brief=1",
                                   f"--gtest_filter={self.only}"],
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=limit,
                                  check=False).returncode == 0
        except subprocess.TimeoutExpired:
            return False

    def judge(self, mutant):
        copy = self.tree / mutant.path
        source = copy.read_text()
        copy.write_text(source[:mutant.begin] + mutant.text + source[mutant.end:])
        try:
            if not self.compiles():
                return "not compiling"
            return "survived" if self.passes(self.limit) else "killed"
        finally:
            self.restore(mutant.path)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sources", nargs="+", help="paths below the repository")
    parser.add_argument("--test", required=True, help="the test program of the room, such as test_field")
    parser.add_argument("--filter", default="*", help="the tests that are asked, as --gtest_filter takes them")
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "mutants")
    parser.add_argument("--option", action="append", default=[], help="for cmake, such as DYNASURF_WERROR=ON")
    parser.add_argument("--log", type=pathlib.Path, help="a line of JSON per mutant is added to this file")
    parser.add_argument("--list", action="store_true", help="only tell which mutants would be tried")
    arguments = parser.parse_args()
    mutants = chosen(arguments.sources, arguments.count, arguments.seed)
    if arguments.list:
        print("\n".join(f"{m.path}:{m.line}: {m.kind}" for m in mutants))
        return
    workshop = Workshop(arguments.build.resolve(), arguments.test, arguments.option, arguments.filter)
    counts = collections.Counter()
    for mutant in mutants:
        verdict = workshop.judge(mutant)
        counts[verdict] += 1
        text = (ROOT / mutant.path).read_text().splitlines()[mutant.line - 1].strip()
        print(f"{verdict:14} {mutant.path}:{mutant.line}: {mutant.kind}   {text}", flush=True)
        if arguments.log:
            with open(arguments.log, "a", encoding="utf-8") as log:
                log.write(json.dumps({"verdict": verdict, "source": text, **dataclasses.asdict(mutant)}) + "\n")
    tried = counts["killed"] + counts["survived"]
    share = 100 * counts["killed"] / tried if tried else 0
    print(f"{tried} mutants, {counts['killed']} killed ({share:.0f} %), {counts['survived']} survived; "
          f"{counts['not compiling']} more did not compile")


if __name__ == "__main__":
    main()
