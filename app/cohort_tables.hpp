#pragma once
#include <filesystem>

namespace dynasurf::app {

/// Makes the tables and the page of a cohort, and tells where they are. Throws InputError, IoError.
void collect_cohort(const std::filesystem::path& cohort, const std::filesystem::path& out, bool quiet);

}  // namespace dynasurf::app
