#include "dynasurf/cohort/detail/cases.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "dynasurf/cohort/detail/job_key.hpp"
#include "dynasurf/cohort/detail/schema_columns.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/json_read.hpp"

namespace dynasurf::cohort {
namespace {

namespace fs = std::filesystem;
using detail::Json;
using detail::value_at;

std::optional<double> number_at(const Json& results, const std::vector<std::string>& path) {
  const Json* value = value_at(results, path);
  return value && value->is_number() ? std::optional(value->get<double>()) : std::nullopt;
}

std::optional<double> end_at(const Json& results, std::vector<std::string> path, std::size_t end) {
  path.back() += "_90";
  const Json* value = value_at(results, path);
  if (!value || !value->is_array() || value->size() != 2 || !(*value)[end].is_number()) return std::nullopt;
  return (*value)[end].get<double>();
}

/// One number of each item of a list.
std::vector<std::optional<double>> column_at(const Json& results, const std::vector<std::string>& list,
                                             const char* key) {
  std::vector<std::optional<double>> numbers;
  if (const Json* items = value_at(results, list); items && items->is_array())
    for (const Json& item : *items) numbers.push_back(number_at(item, {key}));
  return numbers;
}

ReaderDecision decision_in(const Json& results) {
  const auto said = [&](const char* key) {
    const Json* value = value_at(results, {"provenance", "options", "manual", key});
    return value && value->is_string() ? value->get<std::string>() : std::string();
  };
  const std::string decision = said("decision");
  return {decision == "none" ? "" : decision, said("reader"), said("comment")};
}

void take_result(const Json& results, CohortCase& one) {
  one.manual = decision_in(results);
  for (const KeyNumber& key : ventricle_key_numbers()) {
    one.numbers.push_back(number_at(results, key.path));
    one.interval_low.push_back(end_at(results, key.path, 0));
    one.interval_high.push_back(end_at(results, key.path, 1));
  }
  one.perfusion = column_at(results, {"measures", "segments"}, "perfusion_percent");
  one.curve_ml = column_at(results, {"gates"}, "endo_ml");
  const Json* flags = value_at(results, {"quality", "flags"});
  if (!flags || !flags->is_array()) return;
  // The worst first, each code once however many gates have it.
  for (const char* severity : {"failure", "warning", "info"})
    for (const Json& flag : *flags)
      if (const std::string code = flag.value("code", "");
          flag.value("severity", "") == severity &&
          std::find(one.flags.begin(), one.flags.end(), code) == one.flags.end())
        one.flags.push_back(code);
}

/// The results of a study; null when they cannot be read, which its status then says.
std::optional<Json> results_of(const fs::path& cohort, CohortCase& one) {
  try {
    Json results = io::read_json(result_folder(cohort, one.study.id) / "results.json");
    take_result(results, one);
    return results;
  } catch (const std::runtime_error& error) {
    one.status->done = false;
    one.status->verdict.clear();
    one.status->reason = error.what();
    return std::nullopt;
  }
}

}  // namespace

const std::vector<KeyNumber>& ventricle_key_numbers() {
  static const std::vector<KeyNumber> numbers{
      {"ef_percent", "Ejection fraction", "%", {"ef_percent"}},
      {"edv_ml", "End-diastolic volume", "mL", {"edv_ml"}},
      {"esv_ml", "End-systolic volume", "mL", {"esv_ml"}},
      {"sv_ml", "Stroke volume", "mL", {"sv_ml"}},
      {"wall_ml", "Muscle volume", "mL", {"wall_ml"}},
      {"readings_edge_ef_percent", "EF, edge reading", "%", {"readings", "edge", "ef_percent"}},
      {"readings_edge_edv_ml", "EDV, edge reading", "mL", {"readings", "edge", "edv_ml"}},
      {"readings_gaussian_profile_ef_percent",
       "EF, Gaussian profile",
       "%",
       {"readings", "gaussian_profile", "ef_percent"}},
      {"readings_gaussian_profile_edv_ml", "EDV, Gaussian profile", "mL", {"readings", "gaussian_profile", "edv_ml"}},
      {"measures_function_peak_filling_edv_per_s",
       "Peak filling rate",
       "EDV/s",
       {"measures", "function", "peak_filling_edv_per_s"}},
      {"measures_phase_motion_sd_deg", "Phase SD of the motion", "deg", {"measures", "phase", "motion", "sd_deg"}},
      {"measures_phase_motion_bandwidth_deg",
       "Phase bandwidth of the motion",
       "deg",
       {"measures", "phase", "motion", "bandwidth_deg"}},
      {"quality_wall_variation", "Variation of the wall over the beat", "", {"quality", "wall_variation"}}};
  return numbers;
}

Cohort read_cohort(const std::filesystem::path& folder,
                   const std::function<void(const CohortCase&, const nlohmann::ordered_json*)>& use) {
  Cohort cohort;
  cohort.folder = folder;
  StudyList list = read_study_list(folder / "inputs.tsv");
  const auto status = read_status(folder / "status.tsv");
  cohort.group_columns = list.group_columns;
  for (CohortStudy& study : list.studies) {
    CohortCase one;
    one.study = std::move(study);
    // A study that is listed and has no row was not run yet.
    if (const auto row = status.find(one.study.id); row != status.end()) one.status = row->second;
    const std::optional<Json> results = one.has_result() ? results_of(folder, one) : std::nullopt;
    use(one, results ? &*results : nullptr);
    cohort.cases.push_back(std::move(one));
  }
  return cohort;
}

}  // namespace dynasurf::cohort
