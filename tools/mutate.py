#!/usr/bin/env python3
"""Breaks the sources one operator at a time and tells which of the breaks the tests notice.

    tools/mutate.py --room field --count 20 --seed 1
    tools/mutate.py --room writers --log build/mutants.jsonl src/dynasurf/io/manifest.cpp
    tools/mutate.py --table build/mutants.jsonl

Works in a copy of the repository at --build, never in the working tree. A mutant is killed when the tests of the room
fail, crash or take ten times as long; it survives when they pass. Those that do not compile do not count. Some that
survive change nothing that anybody could see (a limit that is never met, an order of equal things); they stay in the list
for a reader to judge. What --log already holds is not tried again, unless it survived and --again is given."""

import argparse
import collections
import dataclasses
import json
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys

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
class Room:
    """Sources, and the tests that are asked about them."""
    test: str
    sources: tuple
    only: str = "*"


# Tests that look at the clock would fail on a busy machine, broken or not.
ROOMS = {
    "core": Room("test_core", ("core/**/*.cpp",), "*-StageClock.*"),
    "image": Room("test_image", ("image/**/*.cpp",), "*-Compass.CostsNoMore*"),
    "field": Room("test_field", ("field/**/*.cpp",)),
    "mesh": Room("test_mesh", ("mesh/**/*.cpp",)),
    "dynamics": Room("test_dynamics", ("dynamics/**/*.cpp",)),
    "writers": Room("test_io", tuple(f"io/{name}.cpp" for name in (
        "atomic_file", "staging", "manifest", "dicom_item", "dicom_write", "nifti_write", "nrrd_write", "glb", "obj",
        "off", "ply", "png", "stl", "vtp", "vtk_xml", "gzip", "options_json", "stage_io"))),
}


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


def limited(seconds):
    """The processor's time, not the clock's: other work on the machine kills no mutant. And memory, of which a broken
    loop may want all."""
    def apply():
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
    return apply


MEMORY = 4 << 30


class Workshop:
    """A copy of the sources with a build folder of its own."""

    def __init__(self, tree, test, options, only):
        # As in the repository, so that a cache of compilers knows all but the broken sources.
        self.tree, self.build, self.test = tree, tree / "build" / "release", test
        listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=ROOT, check=True,
                                capture_output=True, text=True)
        for name in filter(None, listed.stdout.split("\0")):
            self.restore(name)
        subprocess.run(["cmake", "--preset", "release", *(f"-D{option}" for option in options)], cwd=self.tree, check=True,
                       stdout=subprocess.DEVNULL)
        if not self.compiles():
            sys.exit("the unbroken sources do not compile")
        report, before = self.build / "mutants.json", resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        if not self.passes(only, 3600, f"--gtest_output=json:{report}"):
            sys.exit("the tests fail without a break")
        self.limit = max(10, int(10 * (resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before)))
        self.courses = in_courses(json.loads(report.read_text()))

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

    def passes(self, tests, limit, *arguments):
        try:
            return subprocess.run([self.build / "bin" / self.test, "--gtest_fail_fast", "--gtest_brief=1",
                                   f"--gtest_filter={tests}", *arguments], preexec_fn=limited(limit),
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=3600,
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
            return "survived" if all(self.passes(tests, self.limit) for tests in self.courses) else "killed"
        finally:
            self.restore(mutant.path)


def in_courses(report):
    """The tests that ran, as filters: the quick ones, which find most breaks, then the others, which take most time."""
    times = sorted((float(case["time"].rstrip("s")), f"{suite['name']}.{case['name']}")
                   for suite in report["testsuites"] for case in suite["testsuite"] if case["status"] == "RUN")
    total, passed, courses = sum(time for time, _ in times), 0.0, ([], [])
    for time, name in times:
        passed += time
        courses[passed > total / 5].append(name)
    return [":".join(names) for names in courses if names]


def judged(log):
    """The lines of a log by mutant; a later verdict takes the place of an earlier one."""
    lines = map(json.loads, log.read_text().splitlines()) if log and log.exists() else ()
    return {(line["path"], line["begin"], line["text"]): line for line in lines}


def table(lines):
    """What the log says: a line per room, and all that survived."""
    counts = collections.defaultdict(collections.Counter)
    for line in lines:
        counts[line["room"]][line["verdict"]] += 1
        counts["all"][line["verdict"]] += 1
    for room in sorted(counts, key=lambda name: (name == "all", name)):
        count = counts[room]
        tried = count["killed"] + count["survived"]
        yield (f"{room:9} {tried:4} mutants, {count['killed']:4} killed ({100 * count['killed'] / max(1, tried):.1f} %), "
               f"{count['survived']:3} survived; {count['not compiling']} more did not compile")
    for line in sorted(lines, key=lambda line: (line["path"], line["line"])):
        if line["verdict"] == "survived":
            yield f"survived: {line['path']}:{line['line']}: {line['kind']}: {line['source']}"


def parsed():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sources", nargs="*", help="paths below the repository; else those of the room")
    parser.add_argument("--room", choices=sorted(ROOMS))
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "mutants")
    parser.add_argument("--option", action="append", default=[], help="for cmake, such as DYNASURF_WERROR=ON")
    parser.add_argument("--log", type=pathlib.Path, help="a line of JSON per mutant is added to this file")
    parser.add_argument("--again", action="store_true", help="try those of the log that survived, and no others")
    parser.add_argument("--list", action="store_true", help="only tell which mutants would be tried")
    parser.add_argument("--table", type=pathlib.Path, help="only tell what a log says")
    arguments = parser.parse_args()
    if not arguments.table and not arguments.room:
        parser.error("--room or --table is needed")
    return arguments


def main():
    arguments = parsed()
    if arguments.table:
        print("\n".join(table(judged(arguments.table).values())))
        return
    room, known = ROOMS[arguments.room], judged(arguments.log)
    paths = arguments.sources or sorted({path.relative_to(ROOT).as_posix() for pattern in room.sources
                                         for path in (ROOT / "src/dynasurf").glob(pattern)})
    mutants = chosen(paths, arguments.count, arguments.seed)
    verdicts = [known.get((mutant.path, mutant.begin, mutant.text), {}).get("verdict") for mutant in mutants]
    mutants = [mutant for mutant, verdict in zip(mutants, verdicts)
               if verdict == ("survived" if arguments.again else None)]
    if arguments.list:
        print("\n".join(f"{m.path}:{m.line}: {m.kind}" for m in mutants))
        return
    workshop = Workshop(arguments.build.resolve(), room.test, arguments.option, room.only)
    lines = []
    for mutant in mutants:
        text = (ROOT / mutant.path).read_text().splitlines()[mutant.line - 1].strip()
        lines.append({"room": arguments.room, "verdict": workshop.judge(mutant), "source": text, **dataclasses.asdict(mutant)})
        print(f"{lines[-1]['verdict']:14} {mutant.path}:{mutant.line}: {mutant.kind}   {text}", flush=True)
        if arguments.log:
            with open(arguments.log, "a", encoding="utf-8") as log:
                log.write(json.dumps(lines[-1]) + "\n")
    print("\n".join(table(lines)))


if __name__ == "__main__":
    main()
