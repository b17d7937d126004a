"""The checks of tools/ find what they are there to find."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import mutate  # pylint: disable=wrong-import-position

ARCHITECTURE = """
| floor | module | holds | may include | third party |
|---|---|---|---|---|
| 1 | core | values | - | Eigen, oneTBB (one source) |
| 2 | mesh | shapes | core | - |
| 5 | io | files | core, mesh | zlib |
| 6 | app | programs | all | CLI11 |
"""


class Project(unittest.TestCase):
    """A small project in a folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.write("docs/architecture.md", ARCHITECTURE)

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def run_tool(self, tool, *arguments):
        run = subprocess.run([sys.executable, ROOT / "tools" / tool, *map(str, arguments)], capture_output=True, text=True)
        return run.returncode, run.stdout + run.stderr


class CheckNames(Project):
    def check(self, first, second):
        self.write("src/dynasurf/mesh/a.hpp", "namespace dynasurf {\n\n" + first + "\n\n}  // namespace dynasurf\n")
        self.write("src/dynasurf/cloud/b.hpp", "namespace dynasurf {\n\n" + second + "\n\n}  // namespace dynasurf\n")
        return self.run_tool("check_names.py", self.root)

    def test_finds_a_type_that_is_defined_twice(self):
        for second in ("struct Cup {\n  int b;\n};", "class Cup final : public A {\n};", "enum class Cup { a };"):
            code, text = self.check("struct Cup {\n  double a;\n};", second)
            self.assertEqual(code, 1, second)
            self.assertIn("dynasurf::Cup is defined in src/dynasurf/cloud/b.hpp and in src/dynasurf/mesh/a.hpp", text)

    def test_accepts_types_that_differ_are_declared_or_are_local(self):
        for second in ("struct Bowl {\n};", "struct Cup;", "namespace {\nstruct Cup {\n};\n}  // namespace"):
            code, text = self.check("struct Cup {\n  double a;\n};", second)
            self.assertEqual(code, 0, text)

    def test_looks_into_unnamed_namespaces_of_the_program_which_is_compiled_at_once(self):
        for path in ("app/a.cpp", "app/b.cpp"):
            self.write(path, "namespace dynasurf::app {\nnamespace {\nstruct Cup {\n};\n}  // namespace\n}  // namespace dynasurf::app\n")
        code, text = self.run_tool("check_names.py", self.root)
        self.assertEqual(code, 1)
        self.assertIn("dynasurf::app::Cup is defined in app/a.cpp and in app/b.cpp", text)


class CheckSources(Project):
    """The rules of one header of module mesh, and of one source."""

    def check(self, text, path="src/dynasurf/mesh/a.hpp"):
        self.write(path, text)
        return self.run_tool("check_sources.py", self.root)

    def in_mesh(self, text):
        return "namespace dynasurf::mesh {\n\n" + text + "\n\n}  // namespace dynasurf::mesh\n"

    def test_finds_a_namespace_of_another_module(self):
        code, text = self.check("namespace dynasurf::cloud {\n\n/// A.\nint f();\n\n}  // namespace dynasurf::cloud\n")
        self.assertEqual(code, 1)
        self.assertIn("src/dynasurf/mesh/a.hpp:1: namespace dynasurf::cloud; expected dynasurf::mesh", text)

    def test_lets_another_module_be_declared_forward(self):
        self.assertEqual(self.check("namespace dynasurf::cloud {\nstruct A;\n}\n" + self.in_mesh("/// B.\nint f(A);"))[0], 0)

    def test_finds_a_public_name_without_a_sentence(self):
        for name in ("struct A {\n};", "int f(int n);", "using A = int;", "enum class A { a };", "template <class T>\nint f(T);"):
            code, text = self.check(self.in_mesh(name))
            self.assertEqual(code, 1, name)
            self.assertIn("has no sentence", text)
            self.assertEqual(self.check(self.in_mesh("/// Says what.\n" + name))[0], 0, name)

    def test_asks_for_no_sentence_where_nobody_reads_it(self):
        self.assertEqual(self.check(self.in_mesh("int f(int n);"), "src/dynasurf/mesh/detail/b.hpp")[0], 0)

    def test_finds_functions_and_files_that_are_too_long(self):
        for lines, expected in ((58, 0), (59, 1)):
            code, text = self.check(self.in_mesh("int f(int a,\n      int b) {\n" + "  step();\n" * (lines - 1) + "}"),
                                    "src/dynasurf/mesh/b.cpp")
            self.assertEqual(code, expected, text)
        self.assertIn("this function has 61 lines", text)
        self.assertIn("has 506 lines", self.check(self.in_mesh("// a\n" * 501), "src/dynasurf/mesh/b.cpp")[1])
        for lines, expected in ((150, 0), (151, 1)):
            self.write("src/dynasurf/mesh/b.cpp", "")
            self.assertEqual(self.check("// a\n" * lines, "app/b.cpp")[0], expected)


    def test_finds_tests_that_lie_elsewhere_than_their_sources(self):
        for path, message in (("solvers/rk4_test.cpp", ""), ("laws_test.cpp", ""), ("detail_test.cpp", ""),
                              ("rk4_test.cpp", "expected in tests/mesh/solvers, as the source of this name"),
                              ("stops/any_test.cpp", "src/dynasurf has no folder mesh/stops")):
            self.write("src/dynasurf/mesh/solvers/detail/rk4.hpp", "")
            self.write("tests/mesh/" + path, "")
            code, text = self.run_tool("check_sources.py", self.root)
            self.assertEqual(code, 1 if message else 0, text)
            self.assertIn(f"tests/mesh/{path}: {message}" if message else "are in order", text)
            (self.root / "tests/mesh" / path).unlink()


class CheckStreams(Project):
    def test_refuses_streams_that_swallow_the_want_of_memory(self):
        for line, refused in (("std::ostringstream text;", True), ("std::ifstream file(path);", True),
                              ("TextOutput text;  // not std::ostringstream", False)):
            self.write("src/dynasurf/mesh/a.cpp", line + "\n")
            code, text = self.run_tool("check_streams.py", self.root)
            self.assertEqual(code, int(refused), text)
            self.assertEqual("src/dynasurf/mesh/a.cpp:1: " in text, refused)


class CheckSameBytes(Project):
    def check(self, line, path="src/dynasurf/mesh/a.cpp"):
        self.write(path, line + "\n")
        code, text = self.run_tool("check_same_bytes.py", self.root)
        self.write(path, "")
        return code, text

    def test_accepts_own_functions_and_exact_ones(self):
        for line in ("x = own::exp(y) + std::sqrt(z) + std::fma(a, b, c);", "// std::exp would do", 'f("exp(x)");',
                     "at = axes.polar(p) + std::remainder(x, 360.0);", "wave.log(x); my::sin(x); catalog(x);"):
            code, text = self.check(line)
            self.assertEqual(code, 0, text)

    def test_refuses_what_libraries_round(self):
        for line in ("x = std::exp(y);", "x = sin(y);", "x = ::hypot(y, z);", "x = std::pow(2.0F, y);", "f(&std::cos);",
                     "x = y.array().log();", "std::normal_distribution<double> n;", "Eigen::AngleAxisd turn(a, b);",
                     "axes.computeDirect(m);", "long double x;"):
            code, text = self.check(line)
            self.assertEqual(code, 1, line)
            self.assertIn("src/dynasurf/mesh/a.cpp:1: ", text)
        self.assertEqual(self.check("x = std::exp(y);", "app/a.cpp")[0], 1)

    def test_lets_the_own_functions_name_what_they_replace(self):
        self.assertEqual(self.check("double exp(double x);", "src/dynasurf/core/detail/elementary.hpp")[0], 0)


class CheckIncludes(Project):
    def check(self, path, include):
        self.write(path, f"#include {include}\n")
        return self.run_tool("check_includes.py", self.root)

    def test_accepts_what_stands_on_the_line_of_a_module(self):
        for include in ('"dynasurf/core/grid.hpp"', '"dynasurf/mesh/shapes.hpp"', "<vector>", "<Eigen/LU>"):
            code, text = self.check("src/dynasurf/mesh/a.cpp", include)
            self.assertEqual(code, 0, text)

    def test_refuses_a_module_that_stands_above(self):
        code, text = self.check("src/dynasurf/core/a.hpp", '"dynasurf/mesh/shapes.hpp"')
        self.assertEqual(code, 1)
        self.assertIn("src/dynasurf/core/a.hpp:1: core may not include mesh", text)

    def test_refuses_a_library_of_another_module(self):
        for include in ("<zlib.h>", "<CLI/CLI.hpp>", "<tbb/parallel_for.h>"):
            self.assertEqual(self.check("src/dynasurf/mesh/a.cpp", include)[0], 1, include)

    def test_refuses_a_library_that_nobody_listed(self):
        self.assertIn("belongs to no library", self.check("src/dynasurf/io/a.cpp", "<boost/any.hpp>")[1])

    def test_refuses_system_headers_in_the_lower_floors(self):
        self.assertEqual(self.check("src/dynasurf/mesh/a.cpp", "<unistd.h>")[0], 1)
        self.write("src/dynasurf/mesh/a.cpp", "")
        self.assertEqual(self.check("src/dynasurf/io/a.cpp", "<unistd.h>")[0], 0)

    def test_refuses_own_headers_without_their_path(self):
        self.assertIn("full path", self.check("src/dynasurf/mesh/a.cpp", '"shapes.hpp"')[1])

    def test_refuses_a_second_source_of_a_library_meant_for_one(self):
        self.assertEqual(self.check("src/dynasurf/core/a.cpp", "<tbb/tbb.h>")[0], 0)
        code, text = self.check("src/dynasurf/core/b.cpp", "<tbb/tbb.h>")
        self.assertEqual(code, 1)
        self.assertIn("oneTBB is meant for one source of core", text)

    def test_refuses_a_table_that_leads_upwards(self):
        self.write("docs/architecture.md", ARCHITECTURE.replace("| values | - |", "| values | mesh |"))
        self.assertIn("stands above it", self.check("src/dynasurf/core/a.cpp", "<vector>")[1])


class CheckHeaders(Project):
    def setUp(self):
        super().setUp()
        self.write("src/dynasurf/mesh.hpp", '#include "dynasurf/mesh/a.hpp"\n')
        self.write("src/dynasurf/mesh/a.hpp", "")

    def check(self):
        return self.run_tool("check_headers.py", self.root)

    def test_finds_headers_that_include_each_other_by_their_sources(self):
        self.write("src/dynasurf/mesh/a.cpp", '#include "dynasurf/mesh/detail/b.hpp"\n')
        self.write("src/dynasurf/mesh/detail/b.hpp", "")
        self.assertEqual(self.check()[0], 0)
        self.write("src/dynasurf/mesh/b.cpp", '#include "dynasurf/mesh/a.hpp"\n')
        self.assertIn("in a circle: dynasurf/mesh/a, dynasurf/mesh/b", self.check()[1])

    def test_wants_every_public_header_in_that_of_the_module_and_no_other(self):
        self.write("src/dynasurf/mesh/b.hpp", "")
        self.assertIn("src/dynasurf/mesh.hpp: does not include dynasurf/mesh/b.hpp", self.check()[1])
        (self.root / "src/dynasurf/mesh/b.hpp").rename(self.root / "src/dynasurf/mesh/c.cpp")
        self.assertEqual(self.check()[0], 0)
        self.write("src/dynasurf/mesh.hpp", '#include "dynasurf/mesh/a.hpp"\n#include "dynasurf/mesh/detail/b.hpp"\n')
        self.assertIn("dynasurf/mesh/detail/b.hpp is no public header of it", self.check()[1])

    def test_keeps_examples_to_public_headers(self):
        self.write("examples/x.cpp", '#include "dynasurf/mesh/detail/b.hpp"\n')
        self.assertIn("examples/x.cpp: dynasurf/mesh/detail/b.hpp is not public", self.check()[1])


class CheckThesisMap(Project):
    def check(self, row):
        self.write("src/a.cpp", "")
        self.write("tests/core/a_test.cpp", "TEST(Sum, AddsTwoNumbers) {}\n")
        self.write("docs/thesis-map.md", f"| item | thesis | file | test |\n|---|---|---|---|\n{row}\n")
        self.write("tools/thesis_items.txt", "SUM\n" if row else "")
        return self.run_tool("check_thesis_map.py", self.root)

    def test_accepts_files_and_tests_that_exist(self):
        for test in ("`Sum`", "`Sum.AddsTwoNumbers`", "`tests/core/a_test.cpp`"):
            code, text = self.check(f"| SUM | 1.2 | `src/a.cpp` | {test} |")
            self.assertEqual(code, 0, text)

    def test_refuses_what_does_not_exist(self):
        self.assertIn("file 'src/b.cpp'", self.check("| SUM | 1.2 | `src/b.cpp` | `Sum` |")[1])
        self.assertIn("test 'Sum.Other'", self.check("| SUM | 1.2 | `src/a.cpp` | `Sum.Other` |")[1])
        self.assertIn("no test for SUM", self.check("| SUM | 1.2 | `src/a.cpp` | |")[1])

    def test_refuses_an_empty_map(self):
        self.assertEqual(self.check("")[0], 1)

    def test_misses_an_item_that_is_not_told(self):
        row = "| OTHER | 1.2 | `src/a.cpp` | `Sum` |"
        self.assertIn("no row for SUM", self.check(row)[1])
        self.assertEqual(self.check(row + "\n\n* SUM: nobody adds\n")[0], 0)
        self.assertIn("no row for SUM", self.check(row + "\n\n* SUM:\n")[1])


class CheckDocs(Project):
    def check(self, text, *arguments):
        self.write("docs/page.md", text)
        self.write("program", '#!/bin/sh\necho "| \`field.mu\` | 0.2 | | | balance |"\n')
        (self.root / "program").chmod(0o755)
        return self.run_tool("check_docs.py", "--root", self.root, "--program", self.root / "program", *arguments)

    def test_follows_links_to_files_and_headings(self):
        good = "# One thing, `two`\n[a](architecture.md) [b](#one-thing-two) [c](https://example.org)\n"
        self.assertEqual(self.check(good)[0], 0)
        self.assertIn("leads nowhere", self.check("[a](missing.md)\n")[1])
        self.assertIn("no heading #three", self.check(good + "[d](#three)\n")[1])

    def test_compares_defaults_of_options_with_the_program(self):
        table = "| option | default | meaning |\n|---|---|---|\n| `field.{}` | {} | balance |\n"
        self.assertEqual(self.check(table.format("mu", "0.2"))[0], 0)
        self.assertIn("the default of 'field.mu' is 0.2, not 0.3", self.check(table.format("mu", "0.3"))[1])
        self.assertIn("no option 'field.nu'", self.check(table.format("nu", "0.2"))[1])

    def test_inserts_measured_numbers_and_refuses_others(self):
        self.write("experiments/one/run.json", '{"runs": [{"error": 1.26}]}')
        self.write("experiments/one/results.txt", "all   44  25\n  small | 4 | 2 |\n")
        page = ("<!-- figure experiments/one/run.json runs.0.error %.1f -->1.3<!-- end -->\n"
                "<!-- figure experiments/one/results.txt all:2 -->25<!-- end -->\n"
                "<!-- figure experiments/one/results.txt small:1 -->4<!-- end -->\n")
        self.assertEqual(self.check(page)[0], 0)
        code, text = self.check(page.replace("1.3", "1.4"))
        self.assertEqual(code, 1)
        self.assertIn("run.json runs.0.error %.1f is not what the file says", text)
        self.assertEqual(self.check(page.replace("1.3", "1.4"), "--update")[0], 0)
        self.assertEqual((self.root / "docs/page.md").read_text(), page)
        self.assertEqual(self.check(page.replace("small:1", "large:1"))[0], 1)

    def test_refuses_more_text_than_anybody_reads(self):
        self.assertIn("bytes", self.check("word " * 40_000)[1])

    def test_wants_one_sentence_a_line(self):
        fine = "**Camera** (`render`). It blurs, see fig. 3 and eq. D.3.\n| One cell. Two sentences. | x |\n    code. Code\n"
        self.assertEqual(self.check(fine)[0], 0)
        self.assertIn("page.md:2: more than one sentence", self.check("One line.\nIt is here. It is there.\n")[1])

    def test_leads_links_of_a_page_to_pages_of_the_site(self):
        code, text = self.run_tool("site_page.py", ROOT / "README.md")
        self.assertEqual(code, 0, text)
        self.assertIn("# Dynasurf {#README}", text)
        self.assertIn("(@ref docs_validation)", text)
        self.assertIn("(@ref docs_file_formats__the_output_folder)", text)
        self.assertIn('<a href="../../LICENSE">Licence</a>', text)
        self.assertIn("(docs/images/report.jpg)", text)

    def test_makes_the_page_of_a_schema(self):
        schema = {"title": "a/1", "description": "A result.", "$defs": {"gate": {"description": "A gate.", "properties": {
            "time": {"type": ["number", "null"], "description": "ms | s"}}}},
                  "properties": {"gates": {"type": "array", "items": {"$ref": "#/$defs/gate"}, "description": "in order"},
                                 "first": {"anyOf": [{"$ref": "#/$defs/gate"}, {"type": "null"}]}}}
        self.write("a.json", json.dumps(schema))
        code, text = self.run_tool("schema_page.py", self.root / "a.json")
        self.assertEqual(code, 0, text)
        self.assertIn("| `gates` | array of [gate](#gate) | in order |", text)
        self.assertIn("| `first` | [gate](#gate) or null | A gate. |", text)
        self.assertIn("| `time` | number or null | ms \\| s |", text)

    def test_wants_words_for_every_key_of_a_schema(self):
        schema = '{"properties": {"a": {"description": "one"}, "b": {"$ref": "#/$defs/c"}}, "$defs": {"c": {%s}}}'
        self.write("docs/results.schema.json", schema % '"description": "two"')
        self.assertEqual(self.check("")[0], 0)
        self.write("docs/results.schema.json", schema % "")
        self.assertIn("'b' has no description", self.check("")[1])

    def test_finds_unfinished_places(self):
        self.assertIn("unfinished", self.check("TO" + "DO: write this\n")[1])


class Mutate(Project):
    def changes(self, source):
        """The lines that differ, for every mutant of a source."""
        found = {}
        for mutant in mutate.sites("a.cpp", source):
            broken = source[:mutant.begin] + mutant.text + source[mutant.end:]
            found.setdefault(mutant.line, []).append(broken.splitlines()[mutant.line - 1].strip())
        return found

    def test_breaks_operators_numbers_returns_and_statements(self):
        found = self.changes("int f(int a) {\n  if (a < 3 && !g(a)) return 0;\n  a += 2;\n  return a * b;\n}\n")
        self.assertEqual(set(found[2]), {"if (a <= 3 && !g(a)) return 0;", "if (a < 3 || !g(a)) return 0;",
                                         "if (a < 4 && !g(a)) return 0;", "if (a < 3 && g(a)) return 0;",
                                         "if (a < 3 && !g(a)) return 1;", "if (a < 3 && !g(a)) return -(0);"})
        self.assertEqual(set(found[3]), {"a -= 2;", "a += 3;", ";"})
        self.assertEqual(set(found[4]), {"return a / b;", "return -(a * b);"})

    def test_leaves_alone_what_no_test_of_numbers_can_see(self):
        for line in ("// a + b", "const char* c = \"a + b\";", "/* a + b */", "DYNASURF_ASSERT(a > b);", "#include <a + b>",
                     "throw InputError(a + b);", "std::vector<int> v;", "static_assert(a == b);", "T* p;", "f(T&& t);"):
            self.assertEqual(self.changes(line + "\n"), {}, line)

    def test_draws_the_same_mutants_again_and_all_kinds_of_them(self):
        self.write("a.cpp", "  a = b + c;\n  d = e < f;\n  g = h + i;\n")
        drawn = [mutate.chosen(["a.cpp"], 3, seed, self.root) for seed in (1, 1, 2)]
        self.assertEqual(drawn[0], drawn[1])
        self.assertEqual({mutant.kind for mutant in drawn[2]}, {"+ to -", "< to <=", "statement deleted"})

    def test_knows_the_sources_of_every_room(self):
        for name, room in mutate.ROOMS.items():
            for pattern in room.sources:
                self.assertTrue(list((mutate.ROOT / "src/dynasurf").glob(pattern)), f"{name}: {pattern}")

    def test_asks_quick_tests_first_and_every_test_once(self):
        times = {"A.a": "9s", "A.b": "0.5s", "B.c": "0.1s", "B.d": "0.4s"}
        suites = [{"name": suite, "testsuite": [{"name": name[2:], "time": time, "status": "RUN"}
                                                for name, time in times.items() if name[0] == suite]} for suite in "AB"]
        suites[0]["testsuite"].append({"name": "off", "time": "0s", "status": "NOTRUN"})
        self.assertEqual(mutate.in_courses({"testsuites": suites}), ["B.c:B.d:A.b", "A.a"])

    def test_counts_the_last_verdict_of_each_mutant_and_lists_survivors(self):
        def line(verdict, begin, room="core"):
            return {"room": room, "verdict": verdict, "path": "a.cpp", "line": begin, "begin": begin, "text": "-",
                    "kind": "+ to -", "source": "a + b"}
        lines = [line("survived", 1), line("killed", 2), line("survived", 3, "mesh"), line("not compiling", 4), line("killed", 1)]
        self.write("log", "\n".join(map(json.dumps, lines)))
        self.assertEqual(list(mutate.table(mutate.judged(self.root / "log").values())), [
            "core         2 mutants,    2 killed (100.0 %),   0 survived; 1 more did not compile",
            "mesh         1 mutants,    0 killed (0.0 %),   1 survived; 0 more did not compile",
            "all          3 mutants,    2 killed (66.7 %),   1 survived; 1 more did not compile",
            "survived: a.cpp:3: + to -: a + b"])


if __name__ == "__main__":
    unittest.main()
