#include <algorithm>
#include <map>
#include <memory>
#include <thread>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "dynasurf/cohort/detail/job_key.hpp"
#include "dynasurf/cohort/detail/table.hpp"
#include "dynasurf/cohort/status.hpp"
#include "dynasurf/cohort/study_list.hpp"
#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/json_read.hpp"

#include "batch_run.hpp"
#include "cohort_tables.hpp"
#include "command.hpp"
#include "console.hpp"
#include "version.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Arguments {
  std::string dataset, out, level, memory = "2G";
  std::vector<std::string> labels, options;
  int jobs = 0;
  double time_limit_s = 60;
  bool quiet = false;
};

/// A study of the dataset: sub-01/[ses-x/]nm/sub-01[_ses-x][_...]_nm.nii.gz and the like.
struct BidsStudy {
  cohort::CohortStudy study;
  std::string participant;  // "sub-01"
  fs::path folder;          // below the dataset: sub-01/ses-x/nm
};

/// The name without "_nm" and its ending; empty for another file.
std::string stem_of(const fs::path& file) {
  const std::string name = file.filename().string();
  for (const char* ending : {"_nm.nii.gz", "_nm.nii", "_nm.dcm", "_nm.nrrd"})
    if (name.ends_with(ending)) return name.substr(0, name.size() - std::string_view(ending).size());
  return {};
}

std::vector<fs::path> sorted_entries(const fs::path& folder, const std::string& prefix) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().filename().string().starts_with(prefix)) entries.push_back(it->path());
  if (error) throw IoError(folder.string() + ": cannot list this folder: " + error.message());
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::vector<BidsStudy> studies_of(const fs::path& dataset) {
  std::vector<BidsStudy> studies;
  for (const fs::path& participant : sorted_entries(dataset, "sub-")) {
    if (!fs::is_directory(participant)) continue;
    std::vector<fs::path> places = sorted_entries(participant, "ses-");
    places.insert(places.begin(), participant);
    for (const fs::path& place : places) {
      if (!fs::is_directory(place / "nm")) continue;
      for (const fs::path& file : sorted_entries(place / "nm", "sub-")) {
        BidsStudy one;
        one.study.id = stem_of(file);
        if (one.study.id.empty()) continue;
        one.study.path = file;
        one.participant = participant.filename().string();
        one.folder = (place / "nm").lexically_relative(dataset);
        studies.push_back(std::move(one));
      }
    }
  }
  if (studies.empty())
    throw InputError(dataset.string() +
                     ": holds no sub-LABEL/[ses-LABEL/]nm/*_nm.nii.gz, .nii, .nrrd or .dcm; expected a "
                     "BIDS dataset with the datatype nm");
  return studies;
}

bool is_group_column(const std::string& name) {
  return name != "path" && name != "id" && name != "series" && name != "fwhm" && name != "fwhm_mm" &&
         name != "options" &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") ==
             std::string::npos &&
         (name.front() < '0' || name.front() > '9');
}

/// The columns of participants.tsv become groups of the studies; "n/a" is not known.
cohort::StudyList joined(const fs::path& dataset, std::vector<BidsStudy>& studies) {
  cohort::StudyList list;
  const fs::path file = dataset / "participants.tsv";
  std::map<std::string, std::vector<std::string>> groups_of;
  if (fs::exists(file)) {
    const auto table = cohort::detail::parse_tsv(io::text_of_file(file), file.string());
    if (table.head.empty() || table.head.front() != "participant_id")
      throw InputError(file.string() + ": line 1: expected participant_id as the first column");
    std::vector<std::size_t> columns;
    for (std::size_t n = 0; n < table.head.size(); ++n)
      if (is_group_column(table.head[n])) columns.push_back(n), list.group_columns.push_back(table.head[n]);
    for (const auto& row : table.rows)
      for (const std::size_t n : columns)
        groups_of[row.cells.front()].push_back(row.cells[n] == "n/a" ? "" : row.cells[n]);
  } else {
    list.group_columns = {"participant_id"};
  }
  for (BidsStudy& one : studies) {
    one.study.groups = groups_of[one.participant];
    one.study.groups.resize(list.group_columns.size());
    if (list.group_columns.front() == "participant_id") one.study.groups.front() = one.participant;
    list.studies.push_back(one.study);
  }
  return list;
}

bool is_asked_for(const BidsStudy& one, const std::vector<std::string>& labels) {
  return labels.empty() || std::any_of(labels.begin(), labels.end(), [&](const std::string& label) {
           return one.participant == (label.starts_with("sub-") ? label : "sub-" + label);
         });
}

/// The derivative dataset says what it is. BIDS has no datatype for single-photon studies: validators are told to pass
/// over nm, and over the cohort's own files.
void describe(const fs::path& out) {
  Json json = Json::object();
  json["Name"] = "Dynasurf";
  json["BIDSVersion"] = "1.8.0";
  json["DatasetType"] = "derivative";
  json["GeneratedBy"] = Json::array(
      {{{"Name", "dynasurf"}, {"Version", version()}, {"Description", "Surfaces and volumes of the left ventricle"}}});
  io::write_file(out / "dataset_description.json", io::json_text(json));
  io::write_file(out / ".bidsignore", "**/nm/\nsub-*/nm/\ncohort/\n");
}

/// What a reader of derivatives looks for, beside the whole results in the cohort: the report and the numbers.
void publish(const fs::path& out, const BidsStudy& one) {
  const fs::path result = cohort::result_folder(out / "cohort", one.study.id);
  const fs::path stem = out / one.folder / (one.study.id + "_desc-dynasurf");
  io::write_file(stem.string() + "_report.html", io::text_of_file(result / "report.html"));
  io::write_file(stem.string() + "_results.json", io::text_of_file(result / "results.json"));
  Json sidecar = Json::object();
  sidecar["Description"] = "Report of dynasurf ventricle; the whole result is in the folder ResultFolder";
  sidecar["Sources"] = Json::array({"bids:raw:" + (one.folder / one.study.path.filename()).generic_string()});
  sidecar["ResultFolder"] = result.lexically_relative(out).generic_string();
  io::write_file(stem.string() + "_report.json", io::json_text(sidecar));
}

ExitCode run_participants(const Arguments& a, const std::stop_token& stop) {
  std::vector<BidsStudy> studies = studies_of(a.dataset);
  const fs::path out = a.out;
  BatchJob job;
  job.cohort = out / "cohort";
  const cohort::StudyList all = joined(a.dataset, studies);
  std::erase_if(studies, [&](const BidsStudy& one) { return !is_asked_for(one, a.labels); });
  if (studies.empty()) throw OptionError("--participant-label: the dataset holds no study of these participants");
  describe(out);
  // All of the dataset's: calls for single participants, which may run at once, share one cohort.
  io::write_file(job.cohort / "inputs.tsv", cohort::study_list_text(all));
  job.list.group_columns = all.group_columns;
  for (const BidsStudy& one : studies) job.list.studies.push_back(one.study);
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
  for (const BidsStudy& one : studies)
    if (const auto row = status.find(one.study.id); row != status.end() && row->second.done) publish(out, one);
  if (!a.quiet)
    print(std::to_string(tally.done) + " of " + std::to_string(tally.studies) + " studies done, " +
          std::to_string(tally.failed) + " failed\nderivatives: " + a.out + "\n");
  return tally.failed > 0 ? not_trustworthy : done;
}

ExitCode run(const Arguments& a, const std::stop_token& stop) {
  if (a.level == "participant") return run_participants(a, stop);
  if (!a.labels.empty()) throw OptionError("--participant-label belongs to the level participant");
  collect_cohort(fs::path(a.out) / "cohort", fs::path(a.out) / "cohort" / "tables", a.quiet);
  return done;
}

}  // namespace

void add_bids(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<Arguments>();
  CLI::App* command = program.add_subcommand(
      "bids",
      "A BIDS app: run the studies sub-LABEL/[ses-LABEL/]nm/*_nm.* of a dataset, then make tables of the group");
  command->add_option("BIDS_DIR", a->dataset, "the dataset")->required();
  command->add_option("OUT", a->out, "folder of the derivatives")->required();
  command->add_option("LEVEL", a->level, "participant: run the studies; group: make the tables")
      ->required()
      ->check(CLI::IsMember({"participant", "group"}));
  command->add_option("OPTIONS", a->options, "behind --, options of ventricle for every study");
  command->add_option("--participant-label,--participant_label", a->labels, "these participants alone")
      ->take_all()
      ->allow_extra_args(false);
  command->add_option("--jobs", a->jobs, "studies at a time (0: as many as the machine has processors)")
      ->check(CLI::Range(0, 4096));
  command->add_option("--time-limit", a->time_limit_s, "seconds that a study may take (60; 0: any)")
      ->check(CLI::Range(0.0, 1e6));
  command->add_option("--memory-limit", a->memory, "memory that a study may take (2G)");
  command->add_flag("--quiet", a->quiet, "print nothing");
  command->callback([a, &chosen] { chosen = [a](std::stop_token stop) { return run(*a, stop); }; });
}

}  // namespace dynasurf::app
