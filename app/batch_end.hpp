#pragma once
#include <filesystem>
#include <string>

#include "dynasurf/cohort/status.hpp"

#include "batch_run.hpp"
#include "child_process.hpp"

namespace dynasurf::app {

/// A message about the input of a study, as a cohort's tables may hold it: without the name of the file or folder,
/// which may be a person's.
std::string without_names(std::string message, const std::filesystem::path& input);

/// How a process ended, and what it said on standard error.
struct StudyEnd {
  ChildEnd process;
  std::string words;
  bool was_too_slow = false;  // and asked to stop
};

/// Fills in what the end says of a study: whether there is a result, its verdict, or the reason of none.
void judge(const StudyEnd& end, const cohort::CohortStudy& study, const BatchJob& job, cohort::StudyStatus& row);

/// Whether a process may have been killed by somebody else: by a signal that is no mistake of its own.
bool is_from_outside(const ChildEnd& end);

}  // namespace dynasurf::app
