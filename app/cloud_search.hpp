#pragma once
#include <filesystem>

#include "dynasurf/core/progress.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::app {

/// The clouds and surfaces below `folder`, told by the endings of their names, in the order of their paths. Texts and
/// tables that may be anything (.txt, .csv) and files with other endings are left out. Throws IoError
/// when a folder cannot be listed, InputError above a million files, Cancelled.
io::StudySearch search_clouds(const std::filesystem::path& folder, const Progress& progress = {});

}  // namespace dynasurf::app
