#include <algorithm>
#include <charconv>
#include <memory>
#include <thread>

#include "dynasurf/cohort/study_list.hpp"
#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"

#include "batch_run.hpp"
#include "batch_search.hpp"
#include "cohort_tables.hpp"
#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

struct BatchArguments {
  std::string input, cohort, shard, memory = "2G", again, command = "ventricle";
  std::vector<std::string> options;
  int jobs = 0;
  double time_limit_s = 60;
  bool quiet = false, no_collect = false;
};

int part_of_shard(const std::string& text, std::string_view part) {
  int value = 0;
  const auto [rest, error] = std::from_chars(part.data(), part.data() + part.size(), value);
  if (error != std::errc{} || rest != part.data() + part.size() || value < 1)
    throw OptionError("--shard is " + text + "; expected I/N, such as 3/50");
  return value;
}

void take_shard(const std::string& text, BatchJob& job) {
  if (text.empty()) return;
  const std::size_t slash = std::min(text.find('/'), text.size());
  job.shard = part_of_shard(text, std::string_view(text).substr(0, slash));
  job.shards = slash < text.size() ? part_of_shard(text, std::string_view(text).substr(slash + 1)) : 0;
  if (job.shard > job.shards) throw OptionError("--shard is " + text + "; expected I/N with I from 1 to N");
}

/// What a batch says itself to every study.
void refuse_own_options(const std::vector<std::string>& options) {
  const auto is = [](const std::string& option, std::string_view name) {
    return option == name || option.starts_with(std::string(name) + "=");
  };
  for (const std::string& option : options) {
    for (const std::string_view own : {"--out", "--replace", "--quiet", "--json", "--threads", "--memory-limit"})
      if (is(option, own)) throw OptionError(std::string(own) + " behind -- : the batch sets it for every study");
    if (is(option, "--trace")) throw OptionError("--trace behind -- : every study would be written to one file");
  }
}

BatchJob job_of(const BatchArguments& a) {
  BatchJob job;
  job.cohort = a.cohort;
  take_shard(a.shard, job);
  refuse_own_options(a.options);
  job.command = a.command;
  job.options = a.options;
  const int processors = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  job.jobs = a.jobs > 0 ? a.jobs : processors;
  // All studies together have as many threads as the machine has processors.
  job.threads = std::max(1, processors / job.jobs);
  job.time_limit_s = a.time_limit_s;
  job.memory_bytes = memory_from_text(a.memory);
  job.again = {a.again == "failed", a.again == "changed", a.again == "all"};
  job.quiet = a.quiet;
  return job;
}

std::string summary_of(const BatchTally& t, const std::string& cohort) {
  const auto number = [](std::size_t n) { return std::to_string(n); };
  std::string text = number(t.done) + " of " + number(t.studies) + " studies done";
  if (t.to_check + t.not_trustworthy > 0)
    text += " (" + number(t.to_check) + " to check, " + number(t.not_trustworthy) + " not trustworthy)";
  text += ", " + number(t.failed) + " failed, " + number(t.run) + " run now\n";
  if (t.failed > 0) text += "failed: their reasons stand in status.tsv; --again failed runs them anew\n";
  if (t.changed > 0)
    text += "changed: " + number(t.changed) +
            " were done with another input, options or program; --again changed runs them anew\n";
  return text + "cohort: " + cohort + "\n";
}

ExitCode run(const BatchArguments& a, const std::stop_token& stop) {
  BatchJob job = job_of(a);
  std::error_code error;
  job.list = fs::is_directory(a.input, error)
                 ? search_for_cohort({a.input, a.cohort, a.command == "cloud", a.quiet}, stop)
                 : cohort::read_study_list(a.input);
  if (job.list.studies.empty()) throw InputError(a.input + ": lists no study");
  fs::create_directories(job.cohort, error);
  if (error) throw IoError(a.cohort + ": cannot make this folder: " + error.message());
  io::write_file(job.cohort / "inputs.tsv", cohort::study_list_text(job.list));
  const BatchTally tally = run_batch(job, stop);
  if (!a.quiet) print(summary_of(tally, a.cohort));
  if (tally.stopped) {
    print_error("stopped on request; " + std::to_string(tally.done) + " of " + std::to_string(tally.studies) +
                " studies are done, and the same command goes on from there");
    return not_trustworthy;
  }
  // A shard is a part: tables of the whole are made when all shards are done, by dynasurf collect.
  if (!a.no_collect && job.shards == 1) collect_cohort(job.cohort, job.cohort / "tables", a.quiet);
  return tally.failed > 0 ? not_trustworthy : done;
}

}  // namespace

void add_batch(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<BatchArguments>();
  CommandLine command(program, "batch",
                      "Run ventricle or cloud on many studies, a process each; run again, it goes on where it ended");
  command
      .option("STUDIES", a->input,
              "table of studies (.tsv, .csv, .jsonl with the column path), or a folder that is searched")
      .required();
  command.option("OPTIONS", a->options, "behind --, options of ventricle or cloud for every study");
  command.option("--out", a->cohort, "folder of the cohort: results, status.tsv, tables").required();
  command.option("--command", a->command, "what is run on each: ventricle (the default) or cloud")
      .one_of({"ventricle", "cloud"});
  command.option("--shard", a->shard, "I/N: run every N-th study from the I-th on, for array jobs");
  command.option("--jobs", a->jobs, "studies at a time (0: as many as the machine has processors)").within(0, 4096);
  command.option("--time-limit", a->time_limit_s, "seconds that a study may take (60; 0: any)").within(0.0, 1e6);
  command.option("--memory-limit", a->memory, "memory that a study may take (2G)");
  command
      .option("--again", a->again,
              "run these although they have ended: failed, changed (another input, options or program), all")
      .one_of({"failed", "changed", "all"});
  command.flag("--no-collect", a->no_collect, "do not make the tables when all is done");
  command.flag("--quiet", a->quiet, "print nothing");
  command.run(chosen, [a](std::stop_token stop) { return run(*a, stop); });
}

}  // namespace dynasurf::app
