#pragma once
#include <filesystem>
#include <memory>

#include <dcmtk/config/osconfig.h>
// DCMTK asks for its configuration header first.
#include <dcmtk/dcmdata/dctk.h>

#include "dynasurf/io/detail/dicom_dictionary.hpp"
#include "dynasurf/io/detail/dicom_outline.hpp"

// How DICOM objects are read. For the sources of this module: it brings DCMTK with it.
namespace dynasurf::io::dicom {

/// The wanted elements of an outline as a data set. DCMTK sees nothing else of the file, so what it needs is bounded
/// by the limits of an outline. Throws InputError when it cannot understand them.
std::unique_ptr<DcmDataset> load_wanted(const std::filesystem::path& path, const DicomOutline& outline);

}  // namespace dynasurf::io::dicom
