"""The manual pages and the completions are in order and offer what the program takes."""

import gzip
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ["DYNASURF_PROGRAM"]
sys.path.insert(0, str(ROOT / "tools"))
import manual  # pylint: disable=wrong-import-position


def output_of(*command, **options):
    return subprocess.run(list(map(str, command)), check=True, capture_output=True, text=True, **options).stdout


class Choices(unittest.TestCase):
    def test_reads_the_words_that_a_description_lists(self):
        for text, words in (("ct, mr, pet or labels", "ct mr pet labels"),
                            ("ply, stl, glb: one or more, with commas between them (ply)", "ply stl glb"),
                            ("ply, stl, of the transitions (ply)", "ply stl"),
                            ("psf_corrected, the default: with the blur; pet, mr: the same; edges: alone; thesis: as published",
                             "psf_corrected pet mr edges thesis"),
                            ("surface; contour: a contour in every slice", "surface contour"),
                            ("mesh that is deformed: auto, sphere or hull", "auto sphere hull"),
                            ("ventricle (the default), cloud or phantom", "ventricle cloud phantom"),
                            ("gap, cycle, or cloud: points of a body", "gap cycle cloud"),
                            ("folder of the result; an untouched former result there is replaced", ""),
                            ("instead: fewest triangles whose mean distance is below this, percent: 0.1%", ""),
                            ("PLY, STL or OBJ file, in mm", ""), ("print nothing", "")):
            self.assertEqual(manual.choices_of(text), words.split(), text)


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        output_of(sys.executable, ROOT / "tools/manual.py", PROGRAM, cls.folder)
        cls.pages = {path.name.removesuffix(".1.gz"): gzip.decompress(path.read_bytes()).decode()
                     for path in (cls.folder / "man1").iterdir()}
        cls.commands = cls.behind()
        cls.groups = {command: parts for command in cls.commands if (parts := cls.behind(command))}

    @staticmethod
    def behind(*command):
        """The commands that the help of the program, or of a command, lists."""
        return re.findall(r"^  (\w+)", output_of(PROGRAM, *command, "--help").partition("Subcommands:")[2], re.MULTILINE)

    @classmethod
    def all_commands(cls):
        return cls.commands + [f"{group} {part}" for group, parts in cls.groups.items() for part in parts]

    def test_there_is_a_page_for_every_command(self):
        self.assertGreater(len(self.commands), 10)
        self.assertEqual(self.groups, {"perfusion": ["build", "score", "compare"]})
        self.assertEqual(set(self.pages), {"dynasurf", *("dynasurf-" + c.replace(" ", "-") for c in self.all_commands())})

    def test_pages_tell_every_option(self):
        for command in self.all_commands():
            page = self.pages["dynasurf-" + command.replace(" ", "-")].replace("\\-", "-")
            for option in re.findall(r"^  (?:-\w,)?(--[\w-]+)", output_of(PROGRAM, *command.split(), "--help"), re.MULTILINE):
                self.assertIn(f"\\fB{option}\\fR", page, command)
            self.assertIn("Not for diagnosis.", page)
            self.assertIn(".SH EXIT STATUS", page)

    def test_formatters_have_nothing_to_complain(self):
        for name, page in self.pages.items():
            for tool in (["groff", "-man", "-Tutf8", "-ww", "-z"], ["mandoc", "-T", "lint", "-W", "warning"]):
                if shutil.which(tool[0]):
                    done = subprocess.run(tool, input=page, capture_output=True, text=True)
                    self.assertEqual((done.returncode, done.stdout + done.stderr), (0, ""), f"{tool[0]} {name}")

    def test_the_same_help_gives_the_same_bytes(self):
        again = self.folder / "again"
        environment = {**os.environ, "SOURCE_DATE_EPOCH": "1700000000"}
        first = self.folder / "first"
        for folder in (first, again):
            output_of(sys.executable, ROOT / "tools/manual.py", PROGRAM, folder, env=environment)
        for path in first.rglob("*"):
            if path.is_file():
                self.assertEqual(path.read_bytes(), (again / path.relative_to(first)).read_bytes(), path)
        self.assertIn('"2023-11-14"', gzip.decompress((first / "man1/dynasurf.1.gz").read_bytes()).decode())

    def completed(self, *words, folder=None):
        """What bash offers for the last of `words`."""
        script = f"""set -u; . '{self.folder / "bash/dynasurf"}'
COMP_WORDS=(dynasurf "$@"); COMP_CWORD=$#; COMPREPLY=(); _dynasurf; printf '%s\\n' "${{COMPREPLY[@]}}" """
        return output_of("bash", "-c", script, "bash", *words, cwd=folder or self.folder).split()

    def test_bash_completes_commands_options_and_choices(self):
        self.assertEqual(set(self.completed("")), set(self.commands))
        self.assertEqual(self.completed("vent"), ["ventricle"])
        self.assertEqual(self.completed("--v"), ["--version"])
        self.assertEqual(self.completed("ventricle", "--mesh"), ["--mesh-format"])
        self.assertEqual(self.completed("ventricle", "study.dcm", "--keep"), ["--keep-stages"])
        self.assertIn("thesis", self.completed("ventricle", "--preset", ""))
        self.assertEqual(self.completed("cloud", "a.ply", "--mesh-format", "ply,v"), ["ply,vtp"])
        self.assertEqual(self.completed("phantom", "pat"), ["pathology", "patient", "patients"])
        self.assertEqual(self.completed("options", "phantom", "heb"), ["hebron"])
        self.assertEqual(self.completed("ventricle", "--threads", ""), [])
        self.assertEqual(self.completed("perfusion", ""), ["build", "score", "compare"])
        self.assertEqual(self.completed("perfusion", "score", "result", "--seg"), ["--segments"])
        self.assertIn("aha17", self.completed("perfusion", "score", "--segments", ""))

    def test_bash_completes_files(self):
        study = self.folder / "studies"
        study.mkdir()
        (study / "rest.dcm").touch()
        self.assertEqual(self.completed("ventricle", "re", folder=study), ["rest.dcm"])
        self.assertEqual(self.completed("ventricle", "rest.dcm", "--mask", "", folder=study), ["rest.dcm"])
        self.assertEqual(self.completed("perfusion", "compare", "--json", "x", "r", folder=study), ["rest.dcm"])

    def test_every_preset_that_is_offered_is_taken(self):
        for subject in ("ventricle", "cloud", "organ"):
            presets = self.completed(subject, "--preset", "")
            self.assertGreaterEqual(len(presets), 3)
            for preset in presets:
                output_of(PROGRAM, "options", subject, "--preset", preset)
        for kind in self.completed("phantom", ""):
            output_of(PROGRAM, "options", "phantom", kind)

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_zsh_reads_its_completion(self):
        path = self.folder / "zsh/_dynasurf"
        output_of("zsh", "-n", path)
        self.assertTrue(path.read_text().startswith("#compdef dynasurf\n"))
        output_of("zsh", "-fc", f"fpath=('{path.parent}' $fpath); autoload -Uz compinit; compinit -D; "
                                "[[ ${_comps[dynasurf]} == _dynasurf ]]")


if __name__ == "__main__":
    unittest.main()
