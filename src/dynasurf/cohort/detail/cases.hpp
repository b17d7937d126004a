#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dynasurf/cohort/status.hpp"
#include "dynasurf/cohort/study_list.hpp"

namespace dynasurf::cohort {

/// A number by which studies are compared.
struct KeyNumber {
  std::string name;   // its column in studies.tsv: "ef_percent"
  std::string title;  // "Ejection fraction"
  std::string unit;
  std::vector<std::string> path;  // in results.json
};

/// Those of the ventricle: the readings, the muscle, the filling, the synchrony.
const std::vector<KeyNumber>& ventricle_key_numbers();

/// A reader's decision on a result: its options manual.decision, manual.reader and manual.comment. Each is empty unless
/// it was given.
struct ReaderDecision {
  std::string decision;  // "accepted", "rejected"
  std::string reader, comment;
};

/// What is kept in memory of a study while a cohort is collected.
struct CohortCase {
  CohortStudy study;
  std::optional<StudyStatus> status;                               // absent: it was never run
  std::vector<std::optional<double>> numbers;                      // one a key number
  std::vector<std::optional<double>> interval_low, interval_high;  // 90 %, likewise
  std::vector<std::string> flags;                                  // codes, the worst first
  std::vector<std::optional<double>> perfusion;                    // percent, one a segment
  std::vector<std::optional<double>> curve_ml;                     // cavity, one a gate
  ReaderDecision manual;
  bool has_result() const { return status && status->done; }
};

struct Cohort {
  std::filesystem::path folder;
  std::vector<std::string> group_columns;
  std::vector<CohortCase> cases;  // in the order of inputs.tsv
};

/// Reads inputs.tsv, status.tsv and the results of a cohort, one result after the other, and calls `use` with each
/// result that stands, after its case is complete. Throws InputError, IoError; a result that cannot be read makes its
/// study one without a result, with the reason.
Cohort read_cohort(const std::filesystem::path& folder,
                   const std::function<void(const CohortCase&, const nlohmann::ordered_json*)>& use);

}  // namespace dynasurf::cohort
