#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "dynasurf/report/detail/dicom_folder.hpp"

#include "reconstruction.hpp"

namespace dynasurf::app {

/// The hash of a file that was given beside the study; absent when none was.
std::optional<std::string> hash_of(const std::filesystem::path& file);

/// The time DICOM results tell: as an earlier run told it; now; or, where equal runs shall give equal bytes, the
/// study's.
std::string dicom_time(const Job& job, bool study_is_dicom);

/// Whose DICOM results these are, and what their UIDs are made from: the inputs, the options, the program, the time.
io::DicomResult dicom_context(const Job& job, const report::Provenance& provenance, bool study_is_dicom);

}  // namespace dynasurf::app
