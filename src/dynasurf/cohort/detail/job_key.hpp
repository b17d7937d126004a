#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/cohort/study_list.hpp"

namespace dynasurf::cohort {

/// SHA-256 over the content of a study: of a file, or of every file below a folder with its place there. Throws IoError
/// when one cannot be read or there are more than 100,000.
std::string input_hash(const std::filesystem::path& study);

/// Sizes and times of change of the same files, as a short hash: while it stays, the content is taken to be the same.
/// Empty when there is no such study.
std::string input_stamp(const std::filesystem::path& study);

/// A short hash of everything else that a result depends on: the command and its words, the content of the files among
/// them ("--options FILE", "--mask=FILE"), and `program`, its version.
std::string settings_hash(const std::vector<std::string>& words, std::string_view program);

/// Where the result of a study stands in a cohort: fanned out by the hash of the id, so that no folder is long.
std::filesystem::path result_folder(const std::filesystem::path& cohort, const std::string& id);

}  // namespace dynasurf::cohort
