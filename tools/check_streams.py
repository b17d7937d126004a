#!/usr/bin/env python3
"""Refuses in src/, app/ and python/ the streams of the library, which swallow the want of memory: a text or a file then
ends where it struck, and nobody is told."""

import pathlib
import re
import sys

from check_same_bytes import without_words

ROOT = pathlib.Path(__file__).resolve().parent.parent
STREAM = re.compile(r"\bstd::(?:w?[io]?stringstream|[io]?fstream)\b")
ALLOWED = {
    "src/dynasurf/core/detail/text_stream.hpp",  # which mends them
    "src/dynasurf/io/machine_memory.cpp",  # a limit of the machine that cannot be read is none
    "src/dynasurf/cohort/detail/table_writer.hpp",  # asked for its state at the end
    "app/rerun_differences.cpp",  # read without the stream, by the iterator of its buffer, which passes it on
}


def check(root):
    failures = []
    for file in sorted([*root.glob("src/dynasurf/**/*.?pp"), *root.glob("app/*.?pp"), *root.glob("python/bindings/*.?pp")]):
        relative = file.relative_to(root).as_posix()
        if relative in ALLOWED:
            continue
        for number, line in enumerate(without_words(file.read_text()).splitlines(), 1):
            if match := STREAM.search(line):
                failures.append(f"{relative}:{number}: {match[0]}: swallows std::bad_alloc; expected TextOutput or TextInput "
                                "(core/text_stream.hpp), write_file or text_of_file")
    return failures


def main():
    failures = check(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT)
    print("\n".join(failures) if failures else "no stream swallows the want of memory")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
