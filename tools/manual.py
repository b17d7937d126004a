#!/usr/bin/env python3
"""Writes the manual pages and the shell completions of the program from what its --help prints.

    manual.py PROGRAM OUT_DIR

OUT_DIR gets man1/dynasurf.1.gz, a page man1/dynasurf-COMMAND.1.gz for each command (of a group of commands, such as
perfusion, also for each of them: dynasurf-perfusion-build.1.gz), bash/dynasurf and zsh/_dynasurf.
The date of the pages is SOURCE_DATE_EPOCH, or else that of the program. The same help gives the same bytes.
"""

import datetime
import gzip
import os
import pathlib
import re
import subprocess
import sys
from dataclasses import dataclass, field

NAME_WIDTH = 30  # of the left column of --help
# Words that a description lists: `a, b or c`, where each may be a choice of the option.
WORD = r"[a-z0-9_]+(?: \(the default\)|, the default)?"
LIST = rf"{WORD}(?:, {WORD})*(?:,? or {WORD})?"


@dataclass
class Entry:
    """An option, an argument or a command: its names, the type of its value ('' for a flag) and what it is for."""

    names: list
    kind: str = ""
    required: bool = False
    many: bool = False
    limits: str = ""
    text: str = ""
    choices: list = field(default_factory=list)


@dataclass
class Page:
    """What `dynasurf [COMMAND] --help` tells; the command of a group has two words."""

    command: str
    title: str
    usage: str
    arguments: list
    options: list
    commands: list
    footer: list


def choices_of(text):
    """The words among which the value is chosen, as the description tells them."""
    described = re.match(rf"({LIST})(:|$| \(|, of )", text)
    parts = text.split("; ")
    if described and re.search(", | or ", described[1]) and len(parts) == 1:
        words = described[1]
    elif len(parts) > 1 and all(re.match(rf"{LIST}(:|$)", part) for part in parts):
        words = ", ".join(re.match(LIST, part)[0] for part in parts)
    elif last := re.search(rf": ({WORD}(?:, {WORD})*,? or {WORD})$", text):
        words = last[1]
    else:
        return []
    words = re.split(r",? or |, ", words.replace(" (the default)", "").replace(", the default", ""))
    return list(dict.fromkeys(words))


def entry_of(head, text):
    """An entry from both columns, such as `--label INT:INT in [1 - 9] REQUIRED` and `value of the muscle`."""
    names, _, rest = head.partition(" ")
    entry = Entry(names.split(","), text=text)
    if limits := re.search(r":\w+ in \[(\S+) - (\S+)\]", rest):
        entry.limits = f"{limits[1]} to {limits[2]}"
    if listed := re.search(r":\{([^}]*)\}", rest):
        entry.choices = listed[1].split(",")
    if kind := re.match(r"(TEXT|INT|UINT|FLOAT|NUMBER|PATH|FILE|DIR)\b", rest):
        entry.kind = kind[1]
    if count := re.search(r" x (\d+)", rest):
        entry.kind = ",".join([entry.kind] * int(count[1]))
    entry.required = "REQUIRED" in rest
    entry.many = "..." in rest
    if entry.kind == "TEXT" and not entry.choices:
        entry.choices = choices_of(text)
    return entry


def entries_of(lines):
    heads = []
    for line in lines:
        if line.startswith("  ") and not line.startswith("   "):
            split = len(line) <= NAME_WIDTH or line[NAME_WIDTH - 1] == " "
            heads.append([line[:NAME_WIDTH].strip(), line[NAME_WIDTH:].strip()] if split else [line.strip(), ""])
        else:
            heads[-1][1] = (heads[-1][1] + " " + line.strip()).strip()
    return [entry_of(*head) for head in heads]


def page_of(program, command):
    text = subprocess.run([program, *command.split(), "--help"], check=True, capture_output=True, text=True).stdout
    title, _, rest = text.partition("Usage: ")
    usage, _, rest = rest.partition("\n")
    sections = {"": []}
    section = ""
    for line in rest.splitlines():
        if re.fullmatch(r"[A-Z]\w+:", line):
            section = line[:-1]
        elif line and not line.startswith(" "):
            section = "footer"
        if line and line != section + ":":
            sections.setdefault(section, []).append(line)
    if not usage.startswith("dynasurf"):
        sys.exit(f"manual.py: the usage line does not begin with the program: {usage}")
    return Page(command, " ".join(title.split()), usage, entries_of(sections.get("Positionals", [])),
                entries_of(sections.get("Options", [])), entries_of(sections.get("Subcommands", [])),
                sections.get("footer", []))


def pages_from(program, command=""):
    """The page of a command and those of all commands behind it."""
    page = page_of(program, command)
    pages = [page]
    for part in page.commands:
        pages += pages_from(program, f"{command} {part.names[0]}".strip())
    return pages


def title_of(command):
    """The name of its manual page."""
    return "-".join(["dynasurf", *command.split()])


def share_choices(pages, names):
    """Where a page only names an argument that others describe, the choices are all of theirs."""
    for name in names:
        entries = [entry for page in pages for entry in page.options + page.arguments if name in entry.names]
        everything = list(dict.fromkeys(choice for entry in entries for choice in entry.choices))
        for entry in entries:
            entry.choices = entry.choices or everything


# --- manual pages ---------------------------------------------------------------------------------------------------

def roff(text):
    """Text as it is, whatever it holds."""
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq").replace("^", "\\(ha").replace("~", "\\(ti")
    return "\\&" + text if text.startswith((".", "'")) else text


def paragraphs_of(entries):
    for entry in entries:
        is_option = entry.names[0].startswith("-")
        names = ", ".join(f"\\fB{roff(name)}\\fR" if is_option else f"\\fI{roff(name)}\\fR" for name in entry.names)
        value = f" \\fI{roff(entry.kind)}\\fR" if is_option and entry.kind else ""
        dots = " ..." if entry.many else ""
        ends = [entry.limits and entry.limits + ".", entry.required and is_option and "Required."]
        text = entry.text[:1].upper() + entry.text[1:] if re.match(r"[a-z]+ [a-z]", entry.text) else entry.text
        yield ".TP"
        yield names + value + dots
        yield roff(" ".join([text + ("" if text.endswith((".", ":")) else "."), *filter(None, ends)]))


def manual_of(page, pages, version, date):
    name = title_of(page.command)
    title = pages[0].title.partition(". ")[0] if not page.command else page.title
    # The words of a usage line: what is typed in bold, what is replaced in italics.
    usage = [f"\\fB{roff(word)}\\fR" if word.islower() else f"\\fI{roff(word)}\\fR" for word in page.usage.split()]
    lines = [f'.TH {name.upper()} 1 "{date}" "dynasurf {version}" "User Commands"', ".SH NAME",
             f"{roff(name)} \\- {roff(title[:1].lower() + title[1:])}", ".SH SYNOPSIS", " ".join(usage)]
    lines += [".SH DESCRIPTION", roff(page.title + ("" if page.title.endswith(".") else "."))]
    if page.command:
        lines.append("Research use only. Not for diagnosis.".replace("-", "\\-"))
    for heading, entries in (("ARGUMENTS", page.arguments), ("OPTIONS", page.options)):
        if entries:
            lines += [f".SH {heading}", *paragraphs_of(entries)]
    if page.commands:
        lines.append(".SH COMMANDS")
        for command in page.commands:
            lines += [".TP", f"\\fB{roff(title_of(f'{page.command} {command.names[0]}'))}\\fR(1)", roff(command.text + ".")]
    codes = [line for line in page.footer if line.startswith("Exit codes:")]
    if codes:
        lines.append(".SH EXIT STATUS")
        for code, meaning in re.findall(r"(\d) ([^0-9]+?)(?:, (?=\d)|\.?$)", codes[0].partition(": ")[2]):
            lines += [".TP", f"\\fB{code}\\fR", roff(meaning[:1].upper() + meaning[1:] + ".")]
    if page.commands:
        others = [title_of(f"{page.command} {command.names[0]}") for command in page.commands]
    else:
        others = ["dynasurf"] + (["dynasurf-options"] if any("--set" in o.names for o in page.options) else [])
    lines.append(".SH SEE ALSO")
    lines += [f".BR {roff(other)} (1){',' if other is not others[-1] else ''}" for other in others]
    return "\n".join(lines) + "\n"


# --- completions ----------------------------------------------------------------------------------------------------

def takes_files(entry):
    """Text that is not chosen from words is most often a file."""
    plain = ("--set", "--vary", "--screen", "--seed", "--memory-limit", "--triangles", "--max-error")
    return entry.kind == "TEXT" and not entry.choices and entry.names[0] not in plain


def values_of(entry):
    """What bash offers for the value of an option or for an argument."""
    if entry.choices:
        return "words " + " ".join(entry.choices)
    return "files" if takes_files(entry) else "none"


def bash_of(pages):
    lines = ["# bash completion of dynasurf, made from its --help", "",
             "_dynasurf_command() {", '  case "$1" in']
    for page in pages:
        words = " ".join(name for option in page.options for name in option.names if name.startswith("--"))
        lines.append(f"    '{page.command}') options='{words}' ;;")
    lines += ["    *) options='' ;;", "  esac", "}", "", "# The commands behind one.", "_dynasurf_commands() {", '  case "$1" in']
    for page in pages:
        if page.commands:
            lines.append(f"    '{page.command}') commands='{' '.join(command.names[0] for command in page.commands)}' ;;")
    lines += ["    *) commands='' ;;", "  esac", "}", "", "# What follows an option, and which arguments a command takes.",
              "_dynasurf_value() {", '  case "$1 $2" in']
    for page in pages[1:]:
        for option in page.options:
            if option.kind:
                names = "|".join(f"'{page.command} {name}'" for name in option.names)
                lines.append(f"    {names}) value='{values_of(option)}' ;;")
        for place, argument in enumerate(page.arguments, 1):
            places = f"'{page.command} {place}'" + (f"|'{page.command} '[0-9]*" if argument.many else "")
            lines.append(f"    {places}) value='{values_of(argument)}' ;;")
    lines += ["    *) value='' ;;", "  esac", "}", "", BASH_FUNCTION]
    return "\n".join(lines)


BASH_FUNCTION = r"""_dynasurf() {
  local current=${COMP_WORDS[COMP_CWORD]} command='' before='' place=0 options='' commands='' value='' word n
  COMPREPLY=()
  for ((n = 1; n < COMP_CWORD; ++n)); do
    word=${COMP_WORDS[n]}
    _dynasurf_commands "$command"
    if [ -n "$commands" ]; then
      case "$word" in -*) ;; *) command=${command:+$command }$word ;; esac
    elif [ -n "$before" ]; then
      before=''
    else
      case "$word" in
        -*)
          _dynasurf_value "$command" "$word"
          [ -z "$value" ] || before=$word
          ;;
        *) place=$((place + 1)) ;;
      esac
    fi
  done
  _dynasurf_command "$command"
  _dynasurf_commands "$command"
  if [ -n "$before" ]; then
    _dynasurf_value "$command" "$before"
  elif [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
    return
  elif [ -n "$commands" ]; then
    mapfile -t COMPREPLY < <(compgen -W "$commands" -- "$current")
    return
  else
    _dynasurf_value "$command" $((place + 1))
  fi
  case "$value" in
    words*) mapfile -t COMPREPLY < <(compgen -W "${value#words }" -- "${current##*,}") ;;
    files)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -f -- "$current")
      ;;
  esac
  # Several words stand with commas between them.
  if [[ $value == words* && $current == *,* ]]; then
    COMPREPLY=("${COMPREPLY[@]/#/${current%,*},}")
  fi
} && complete -F _dynasurf dynasurf
"""


def zsh_quoted(text):
    return text.replace("'", "'\\''").replace("[", "\\[").replace("]", "\\]").replace(":", "\\:")


def zsh_action(entry):
    if entry.choices:
        words = " ".join(entry.choices)
        return f"_sequence compadd - {words}" if entry.many else f"({words})"
    return "_files" if takes_files(entry) else " "


def zsh_of(pages):
    lines = ["#compdef dynasurf", "# zsh completion of dynasurf, made from its --help", "",
             "_dynasurf() {", "  local line state", "  _arguments -C \\"]
    for option in pages[0].options:
        for name in option.names:
            lines.append(f"    '{name}[{zsh_quoted(option.text)}]' \\")
    lines += ["    '1: :->command' '*:: :->arguments'", *zsh_commands(pages[0], pages), "}", "", '_dynasurf "$@"']
    return "\n".join(lines) + "\n"


def zsh_commands(group, pages):
    """What follows the command line of a group: one of its commands, or the arguments of that."""
    lines = ["  case $state in", "    command)", "      local -a commands=("]
    lines += [f"        '{command.names[0]}:{zsh_quoted(command.text)}'" for command in group.commands]
    lines += ["      )", "      _describe command commands", "      ;;", "    arguments)", "      case $line[1] in"]
    for command in group.commands:
        page = next(page for page in pages if page.command == f"{group.command} {command.names[0]}".strip())
        lines.append(f"        {command.names[0]})")
        if page.commands:
            lines += ["          _arguments -C '1: :->command' '*:: :->arguments'",
                      *("        " + line for line in zsh_commands(page, pages)), "          ;;"]
            continue
        lines.append("          _arguments \\")
        specs = []
        for option in page.options:
            for name in option.names:
                value = f":{option.kind.lower()}:{zsh_action(option)}" if option.kind else ""
                repeated = "*" if option.many else ""
                specs.append(f"'{repeated}{name}[{zsh_quoted(option.text)}]{value}'")
        for place, argument in enumerate(page.arguments, 1):
            at = "*" if argument.many else str(place)
            specs.append(f"'{at}:{argument.names[0]}:{zsh_action(argument)}'")
        lines += [f"            {spec}" + (" \\" if spec is not specs[-1] else "") for spec in specs]
        lines.append("          ;;")
    return lines + ["      esac", "      ;;", "  esac"]


def write(path, content):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    program, out = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    pages = pages_from(program)
    share_choices(pages, ("--preset", "KIND"))
    version = subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout.split()[1]
    seconds = int(os.environ.get("SOURCE_DATE_EPOCH") or program.stat().st_mtime)
    date = datetime.datetime.fromtimestamp(seconds, datetime.timezone.utc).strftime("%Y-%m-%d")
    for page in pages:
        text = manual_of(page, pages, version, date).encode()
        write(out / "man1" / f"{title_of(page.command)}.1.gz", gzip.compress(text, 9, mtime=0))
    write(out / "bash/dynasurf", bash_of(pages).encode())
    write(out / "zsh/_dynasurf", zsh_of(pages).encode())


if __name__ == "__main__":
    main()
