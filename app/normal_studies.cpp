#include "normal_studies.hpp"

#include <algorithm>

#include "dynasurf/cohort/detail/job_key.hpp"
#include "dynasurf/cohort/status.hpp"
#include "dynasurf/cohort/study_list.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf::app {
namespace {

std::size_t column_of(const cohort::StudyList& list, const std::string& name) {
  const auto at = std::find(list.group_columns.begin(), list.group_columns.end(), name);
  if (at != list.group_columns.end()) return at - list.group_columns.begin();
  std::string known;
  for (const std::string& column : list.group_columns) known += (known.empty() ? "" : ", ") + column;
  throw OptionError("the cohort has no column " + name + "; expected one of: " + known);
}

}  // namespace

bool is_cohort(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::is_regular_file(folder / "inputs.tsv", error) &&
         std::filesystem::is_regular_file(folder / "status.tsv", error);
}

NormalStudies normal_studies_of(const std::filesystem::path& cohort, const std::vector<std::string>& columns,
                                const ColumnValues& where) {
  const cohort::StudyList list = cohort::read_study_list(cohort / "inputs.tsv");
  const auto status = cohort::read_status(cohort / "status.tsv");
  std::vector<std::size_t> places;
  places.reserve(columns.size());
  for (const std::string& column : columns) places.push_back(column_of(list, column));
  NormalStudies normal;
  for (const cohort::CohortStudy& study : list.studies) {
    const bool is_wanted = std::all_of(where.begin(), where.end(), [&](const auto& wanted) {
      return study.groups[column_of(list, wanted.first)] == wanted.second;
    });
    const auto row = status.find(study.id);
    const std::filesystem::path result = cohort::result_folder(cohort, study.id);
    if (!is_wanted || row == status.end() || !row->second.done || row->second.verdict == "fail" ||
        !std::filesystem::exists(result / "measures" / "polar.csv")) {
      ++normal.left_out;
      continue;
    }
    normal.results.push_back(result);
    normal.values.emplace_back();
    for (const std::size_t place : places) normal.values.back().push_back(study.groups[place]);
  }
  return normal;
}

}  // namespace dynasurf::app
