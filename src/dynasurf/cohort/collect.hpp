#pragma once
#include <filesystem>
#include <optional>
#include <string>

namespace dynasurf::cohort {

/// How many studies went into the tables.
struct CollectTally {
  std::size_t studies = 0, done = 0, failed = 0, not_run = 0;
  std::optional<std::filesystem::path> moved_to;  // where a folder that stood at `out` was moved
};

/// Makes the tables of a cohort in a folder that appears whole: studies.tsv (a row a study), segments.tsv (a row a
/// segment), curves.tsv (a row a gate), dictionary.tsv (what each column means), statistics.tsv, the same tables in
/// cohort.sqlite, and the page cohort.html; with `other`, the folder of another cohort, comparison.tsv too. Columns
/// follow from the published schemas of results, so that they are the same whatever the studies hold. Memory does not
/// grow with what a result holds beside its key numbers. Throws InputError, IoError.
CollectTally collect(const std::filesystem::path& cohort, const std::filesystem::path& out,
                     const std::optional<std::filesystem::path>& other = {}, bool replace = false);

}  // namespace dynasurf::cohort
