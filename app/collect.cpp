#include "dynasurf/cohort/collect.hpp"

#include <memory>

#include "cohort_tables.hpp"
#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "out_argument.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

struct CollectArguments {
  std::string cohort, compare;
  OutFolder out;
  bool quiet = false;
};

std::string summary_of(const cohort::CollectTally& tally, const fs::path& out) {
  const auto number = [](std::size_t n) { return std::to_string(n); };
  std::string text = "tables of " + number(tally.studies) + " studies: " + number(tally.done) + " with a result, " +
                     number(tally.failed) + " failed";
  if (tally.not_run > 0) text += ", " + number(tally.not_run) + " not run";
  text += "\ntables: " + out.string() + "\npage: " + (out / "cohort.html").string() + "\n";
  if (tally.moved_to) text += "moved aside: " + tally.moved_to->string() + "\n";
  return text;
}

ExitCode run(const CollectArguments& a) {
  const std::optional<fs::path> other = a.compare.empty() ? std::nullopt : std::optional<fs::path>(a.compare);
  const cohort::CollectTally tally = cohort::collect(a.cohort, a.out.path, other, a.out.replace);
  if (!a.quiet) print(summary_of(tally, a.out.path));
  return done;
}

}  // namespace

void collect_cohort(const std::filesystem::path& cohort, const std::filesystem::path& out, bool quiet) {
  const cohort::CollectTally tally = cohort::collect(cohort, out);
  if (!quiet) print(summary_of(tally, out));
}

void add_collect(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<CollectArguments>();
  CommandLine command(program, "collect", "Make tables, statistics and one page of all studies that batch has run");
  command.option("COHORT", a->cohort, "folder that batch wrote").required();
  add_out_folder(command, a->out,
                 "folder for studies.tsv, segments.tsv, curves.tsv, statistics.tsv, dictionary.tsv, cohort.sqlite, "
                 "cohort.html")
      .required();
  command.option("--compare", a->compare, "another cohort of the same ids: what changed, by how much, why");
  command.flag("--quiet", a->quiet, "print nothing");
  command.run(chosen, [a](std::stop_token) { return run(*a); });
}

}  // namespace dynasurf::app
