#pragma once
#include <filesystem>
#include <string>

namespace dynasurf::app {

/// A message about the input of a study, as a cohort's tables may hold it: without the name of the file or folder,
/// which may be a person's.
std::string without_names(std::string message, const std::filesystem::path& input);

/// The last error in what a study's process said, without names; empty when it said none.
std::string reason_in(const std::string& words, const std::filesystem::path& input);

}  // namespace dynasurf::app
