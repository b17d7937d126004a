#pragma once
#include <stop_token>
#include <string>

#include "dynasurf/cohort/study_list.hpp"

namespace dynasurf::app {

/// A folder whose studies, or clouds, become a cohort.
struct CohortSearch {
  std::string input, cohort;
  bool clouds = false, quiet = false;
};

/// Looks through the folder, writes left_out.tsv into the cohort, and tells how many there are. Throws OptionError,
/// InputError when there is none, IoError, Cancelled.
cohort::StudyList search_for_cohort(const CohortSearch& asked, const std::stop_token& stop);

}  // namespace dynasurf::app
