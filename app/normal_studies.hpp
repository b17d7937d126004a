#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace dynasurf::app {

/// Results of normal studies, and the values of their group columns.
struct NormalStudies {
  std::vector<std::filesystem::path> results;
  std::vector<std::vector<std::string>> values;  // of each, one a column; empty: not known
  int left_out = 0;                              // without a trustworthy result, or of other values
};

using ColumnValues = std::vector<std::pair<std::string, std::string>>;

/// "sex=F" as a column and its value. Throws OptionError, naming the option.
ColumnValues column_values(const std::vector<std::string>& texts, const std::string& option);

bool is_cohort(const std::filesystem::path& folder);

/// The studies of a cohort that are done and do not have the verdict `fail`, whose columns have the values `where`.
/// Throws OptionError for a column that the cohort does not have, InputError, IoError.
NormalStudies normal_studies_of(const std::filesystem::path& cohort, const std::vector<std::string>& columns,
                                const ColumnValues& where);

}  // namespace dynasurf::app
