#pragma once
#include <filesystem>
#include <memory>

#include <dcmtk/config/osconfig.h>
// DCMTK asks for its configuration header first.
#include <dcmtk/dcmdata/dctk.h>

#include "dynasurf/io/detail/dicom_outline.hpp"

// How DICOM objects are read. For the sources of this module: it brings DCMTK with it.
namespace dynasurf::io::dicom {

/// From here on DCMTK does not print: a library does not, and an error is one line. Its dictionary is loaded. Throws
/// std::bad_alloc where that does not fit.
void prepare_dcmtk();

/// The wanted elements of an outline as a data set. DCMTK sees nothing else of the file, so what it needs is bounded
/// by the limits of an outline. Throws InputError when it cannot understand them.
std::unique_ptr<DcmDataset> load_wanted(const std::filesystem::path& path, const DicomOutline& outline);

/// Whether DCMTK's dictionary knows this tag as a sequence. Throws IoError when there is no dictionary.
bool is_sequence(std::uint32_t tag);

}  // namespace dynasurf::io::dicom
