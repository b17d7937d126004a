#pragma once
#include <filesystem>
#include <vector>

#include "dynasurf/io/study_io.hpp"

namespace dynasurf::io {

/// The DICOM part of `search_studies`: adds to `found` what these files hold. Files that are no DICOM are left out.
void search_dicom(const std::vector<std::filesystem::path>& files, StudySearch& found, const Progress& progress);

}  // namespace dynasurf::io
