#pragma once
#include <cstdint>
#include <string>

namespace dynasurf::io::dicom {

/// Puts off reading DCMTK's dictionary until it is needed. That takes 20 ms, and files with explicit value
/// representations need none. Call it at the start of a program, before there are threads: it changes an environment
/// variable and puts it back.
void leave_dictionary_unread();

/// From here on DCMTK does not print: a library does not, and an error is one line. Its dictionary is read unless it
/// was left. Throws std::bad_alloc where that does not fit.
void prepare_dcmtk();

/// The same with the dictionary. Throws IoError where there is none.
void require_dictionary();

/// Whether DCMTK's dictionary knows this tag as a sequence. Throws IoError when there is no dictionary.
bool is_sequence(std::uint32_t tag);

/// The dictionary's name of a tag. Throws IoError when there is no dictionary.
std::string name_of(std::uint32_t tag);

}  // namespace dynasurf::io::dicom
