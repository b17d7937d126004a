#pragma once
#include <cstdint>

namespace dynasurf::io::dicom {

/// From here on DCMTK does not print: a library does not, and an error is one line. Its dictionary is loaded. Throws
/// std::bad_alloc where that does not fit.
void prepare_dcmtk();

/// The same, and throws IoError where there is no dictionary.
void require_dictionary();

/// Whether DCMTK's dictionary knows this tag as a sequence. Throws IoError when there is no dictionary.
bool is_sequence(std::uint32_t tag);

}  // namespace dynasurf::io::dicom
