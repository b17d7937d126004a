#!/usr/bin/env python3
"""Holds the translations of the pages against their sources: every text has an entry, and no entry is without a text.

A page says its texts by say("sentence"), writes them into its body.html, or names them in program/texts.ts. What the
program says in its results stands in C++, in pieces between values; an entry's text must be made of such pieces, and
every piece of a note and of a reader's refusal must stand in an entry. With --program the options that the page
offers have an entry each. check_words.py --list prints all texts of the pages.
"""
import argparse
import json
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
WEB = ROOT / "web/src"
SPOKEN = ["", "cloud"]  # folders of the pages that dynasurf.html shows
TOLD = ["ventricle", "psf_fit", "field", "dynamics", "image", "io", "cloud"]  # folders of src/dynasurf that write notes
ATTRIBUTES = {"title", "aria-label", "placeholder", "alt"}
# Files whose refusals a user of the page can meet: each has an entry.
READERS = ["core/option_tree.cpp", "core/options.hpp", "cloud/options.cpp", "cloud/prepare.cpp", "psf_fit/wall_terms.cpp",
           "ventricle/cycle.cpp", "ventricle/orientation.cpp", "ventricle/reconstruct.cpp",
           *(f"io/{name}" for name in (
               "byte_source.cpp", "cloud_io.cpp", "detail/nrrd_header.hpp", "detail/text_reader.hpp", "dicom_choice.cpp",
               "dicom_file.cpp", "dicom_frames.cpp", "dicom_load.cpp", "dicom_outline.cpp", "dicom_pixels.cpp", "dicom_places.cpp",
               "dicom_read.cpp", "dicom_slices.cpp", "dicom_stacking.cpp", "dicom_whole.cpp", "e57.cpp", "e57_pages.cpp", "e57_scans.cpp", "las.cpp",
               "nifti_read.cpp",
               "nrrd_header.cpp", "nrrd_read.cpp", "obj.cpp", "off.cpp", "pcd.cpp", "ply.cpp", "ptx.cpp", "rows.cpp", "samples.cpp",
               "stl.cpp", "study_io.cpp", "study_mend.cpp", "told_counts.cpp"))]
REFUSAL = re.compile(r"Error\(|refuse\w*\(|must\(|fail\(|throw ")
# What nobody meets on the page, and what stands in an entry with a place for its list.
NO_REFUSAL = re.compile(
    r"is no setting|fewer than 2|on another grid than the image|exclude_gates names gate|ends in \.ply|the cloud has no point")
# Notes of other subjects, and what is no note: parts of refusals that stand in functions of their own, words of files.
NOT_SHOWN = {"io/tracked_points_io.cpp"}
NO_NOTE = re.compile(
    r"expected|^option |^ply\n|^property |TOMO|^is an? |^is not |^holds (no pixel|projections)|^not slices|^image of an unknown|"
    r"^along the normal|^apart, the others|before the voxels|^dynasurf (slice|cycle)|^the volume has$")
PLACE = re.compile(r"{(\w+)}")
STRING = re.compile(r'"((?:[^"\\\n]|\\.)*)"')


class Texts(HTMLParser):
    """Visible texts and spoken attributes of a page."""

    def __init__(self):
        super().__init__()
        self.found = []
        self.is_shown = True  # not what stands there for a browser without scripts

    def handle_starttag(self, tag, attrs):
        self.is_shown = tag != "noscript" and self.is_shown
        self.found += [value for name, value in attrs if name in ATTRIBUTES]

    def handle_endtag(self, tag):
        self.is_shown = tag == "noscript" or self.is_shown

    def handle_data(self, data):
        if data.strip() and self.is_shown:
            self.found.append(data.strip())


def texts_of_pages(problems):
    found = {}
    for folder in SPOKEN:
        for path in sorted((WEB / folder).glob("*.ts")):
            text = path.read_text(encoding="utf-8")
            for call in re.finditer(r"(?<![\w.])say\((?!english)", text):
                literal = STRING.match(text, call.end())
                if literal:
                    found.setdefault(json.loads(literal[0]), path)
                else:
                    line = text.count("\n", 0, call.start()) + 1
                    problems.append(f"{path.relative_to(ROOT)}:{line}: say() takes a sentence as it is written")
        page = Texts()
        page.feed((WEB / folder / "body.html").read_text(encoding="utf-8"))
        for text in page.found:
            found.setdefault(text, WEB / folder / "body.html")
        title = re.search(r'\["\w+\.html", "%s", "([^"]+)"' % folder, (ROOT / "web/build.mjs").read_text(encoding="utf-8"))
        found.setdefault(f"{title[1]} – Dynasurf", ROOT / "web/build.mjs")
    table = (WEB / "program/texts.ts").read_text(encoding="utf-8").split("const english = {")[1].split("\n};")[0]
    for literal in re.finditer(r'^  \w+: ("(?:[^"\\]|\\.)*"),$', table, re.M):
        found.setdefault(json.loads(literal[1]), WEB / "program/texts.ts")
    return found


def literals_of(path):
    """String literals with what stands before each in its statement; neighbours are one."""
    text = re.sub(r"//[^\n]*", lambda c: "" if c[0].count('"') == 0 else c[0], path.read_text(encoding="utf-8"))
    text = re.sub(r"^#include[^\n]*$", "", text, flags=re.M)
    for whole in re.finditer(r'(?:"(?:[^"\\\n]|\\.)*"\s*)+', text):
        literal = "".join(m[1] for m in STRING.finditer(whole[0]))
        literal = re.sub(r"\\(.)", lambda c: {"n": "\n"}.get(c[1], c[1]), literal)
        yield literal, re.split(r"[;{}] *\n", text[:whole.start()])[-1]


def pieces_of(literal):
    """The texts between the values of a printf pattern."""
    return [piece.replace("%%", "%") for piece in re.split(r"%[-+.0-9]*(?:z|l)*[defgsu]", literal)]


def is_made_of(text, blob):
    """Whether a text is a chain of few pieces of the sources."""
    at = pieces = 0
    while at < len(text):
        length = next((n for n in range(len(text) - at, 0, -1) if text[at:at + n] in blob), 0)
        if length < min(2, len(text) - at) or pieces == 5:
            return False
        at += length
        pieces += 1
    return True


def sentences_of(path, is_wanted):
    """Pieces of three words or more of the literals in statements that are wanted."""
    for literal, before in literals_of(path):
        for piece in pieces_of(literal) if is_wanted(before) else ():
            words = piece.strip(" ,;:().")
            if " " in words and len(re.findall(r"[A-Za-z]{2,}", words)) >= 3:
                yield words


def check_program(name, table, problems):
    blob = "\0".join(
        piece
        for path in [*sorted((ROOT / "src").rglob("*.[ch]pp")), *sorted((ROOT / "app").rglob("*.[ch]pp"))]
        for literal, _ in literals_of(path)
        for piece in pieces_of(re.sub(r"&ndash;", "–", literal)))
    blob = blob.replace("_", " ") + "\0" + blob
    for sentence in table:
        for part in PLACE.split(sentence)[::2]:
            if not is_made_of(part, blob):
                problems.append(f"{name}: the program never says \"{sentence}\" (\"{part}\")")
    sources = ROOT / "src/dynasurf"
    notes = [path for folder in TOLD for path in sorted((sources / folder).rglob("*.cpp"))
             if "Severity::" in path.read_text(encoding="utf-8") and str(path.relative_to(sources)) not in NOT_SHOWN]
    said = [(path, words) for path in notes for words in sentences_of(path, lambda before: not REFUSAL.search(before))
            if not NO_NOTE.search(words)]
    said += [(path, words) for path in map(sources.__truediv__, READERS) for words in sentences_of(path, REFUSAL.search)
             if not NO_REFUSAL.search(words)]
    entries = "\0".join(table)
    problems += [f"{name}: nothing for \"{words}\" of {path.relative_to(sources)}" for path, words in said if words not in entries]


def descriptions(program):
    """What the options that the page offers are, and their units where these are words."""
    rows = [row for subject in ("ventricle", "cloud")
            for row in json.loads(subprocess.run([program, "options", subject, "--json"], check=True, capture_output=True).stdout)]
    return {row["meaning"] for row in rows} | {row["unit"] for row in rows if re.search(r"[a-z]{4}", row["unit"])}


def check(path, texts, options, problems):
    name = path.relative_to(ROOT)
    table = json.loads(path.read_text(encoding="utf-8"))
    problems += [f"{name}: nothing for \"{text}\" of {source.relative_to(ROOT)}" for text, source in texts.items()
                 if text not in table["pages"] and re.search(r"[A-Za-z]?[a-z]{2}", PLACE.sub("", text))]
    problems += [f"{name}: no page says \"{text}\"" for text in table["pages"] if text not in texts]
    for part in ("pages", "program"):
        problems += [f"{name}: other places than in \"{text}\"" for text, said in table[part].items()
                     if set(PLACE.findall(text)) != set(PLACE.findall(said))]
    check_program(name, table["program"], problems)
    if options:
        problems += [f"{name}: nothing for \"{text}\" of an option" for text in sorted(options - table["options"].keys())]
        problems += [f"{name}: no option says \"{text}\"" for text in table["options"] if text not in options]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--list", action="store_true", help="print the texts of the pages")
    parser.add_argument("--program", help="the program, for the descriptions of its options")
    arguments = parser.parse_args()
    problems = []
    texts = texts_of_pages(problems)
    if arguments.list:
        print(json.dumps(list(texts), ensure_ascii=False, indent=1))
        return 0
    options = descriptions(arguments.program) if arguments.program else set()
    for path in sorted((WEB / "translations").glob("*.json")):
        check(path, texts, options, problems)
    print("\n".join(problems) or f"{len(texts)} texts of the pages are translated")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
