#include "dynasurf/cohort/detail/bids.hpp"

#include <algorithm>
#include <memory>
#include <thread>

#include "dynasurf/cohort/status.hpp"
#include "dynasurf/cohort/study_list.hpp"
#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"

#include "batch_run.hpp"
#include "cohort_tables.hpp"
#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "version.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

struct BidsArguments {
  std::string dataset, out, level, memory = "2G";
  std::vector<std::string> labels, options;
  int jobs = 0;
  double time_limit_s = 60;
  bool quiet = false;
};

bool is_asked_for(const cohort::BidsStudy& one, const std::vector<std::string>& labels) {
  // BIDS apps take labels without "sub-"; with it they mean the same.
  return labels.empty() || std::any_of(labels.begin(), labels.end(), [&](const std::string& label) {
           return one.participant == (label.starts_with("sub-") ? label : "sub-" + label);
         });
}

ExitCode run_participants(const BidsArguments& a, const std::stop_token& stop) {
  std::vector<cohort::BidsStudy> studies = cohort::bids_studies(a.dataset);
  const fs::path out = a.out;
  BatchJob job;
  job.cohort = out / "cohort";
  const cohort::StudyList all = cohort::bids_list(a.dataset, studies);
  std::erase_if(studies, [&](const cohort::BidsStudy& one) { return !is_asked_for(one, a.labels); });
  if (studies.empty()) throw OptionError("--participant-label: the dataset holds no study of these participants");
  cohort::describe_derivatives(out, version());
  // All of the dataset's: calls for single participants, which may run at once, share one cohort.
  io::write_file(job.cohort / "inputs.tsv", cohort::study_list_text(all));
  job.list.group_columns = all.group_columns;
  for (const cohort::BidsStudy& one : studies) job.list.studies.push_back(one.study);
  const int processors = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  job.options = a.options;
  job.jobs = a.jobs > 0 ? a.jobs : processors;
  job.threads = std::max(1, processors / job.jobs);
  job.time_limit_s = a.time_limit_s;
  job.memory_bytes = memory_from_text(a.memory);
  job.quiet = a.quiet;
  const BatchTally tally = run_batch(job, stop);
  if (tally.stopped) throw Cancelled("stopped on request");
  const auto status = cohort::read_status(job.cohort / "status.tsv");
  for (const cohort::BidsStudy& one : studies)
    if (const auto row = status.find(one.study.id); row != status.end() && row->second.done)
      cohort::publish_derivatives(out, one);
  if (!a.quiet)
    print(std::to_string(tally.done) + " of " + std::to_string(tally.studies) + " studies done, " +
          std::to_string(tally.failed) + " failed\nderivatives: " + a.out + "\n");
  return tally.failed > 0 ? not_trustworthy : done;
}

ExitCode run(const BidsArguments& a, const std::stop_token& stop) {
  if (a.level == "participant") return run_participants(a, stop);
  if (!a.labels.empty()) throw OptionError("--participant-label belongs to the level participant");
  collect_cohort(fs::path(a.out) / "cohort", fs::path(a.out) / "cohort" / "tables", a.quiet);
  return done;
}

}  // namespace

void add_bids(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<BidsArguments>();
  CommandLine command(
      program, "bids",
      "A BIDS app: run the studies sub-LABEL/[ses-LABEL/]nm/*_nm.* of a dataset, then make tables of the group");
  command.option("BIDS_DIR", a->dataset, "the dataset").required();
  command.option("OUT", a->out, "folder of the derivatives").required();
  command.option("LEVEL", a->level, "participant: run the studies; group: make the tables")
      .required()
      .one_of({"participant", "group"});
  command.option("OPTIONS", a->options, "behind --, options of ventricle for every study");
  command.option("--participant-label,--participant_label", a->labels, "these participants alone").repeated();
  command.option("--jobs", a->jobs, "studies at a time (0: as many as the machine has processors)").within(0, 4096);
  command.option("--time-limit", a->time_limit_s, "seconds that a study may take (60; 0: any)").within(0.0, 1e6);
  command.option("--memory-limit", a->memory, "memory that a study may take (2G)");
  command.flag("--quiet", a->quiet, "print nothing");
  command.run(chosen, [a](std::stop_token stop) { return run(*a, stop); });
}

}  // namespace dynasurf::app
