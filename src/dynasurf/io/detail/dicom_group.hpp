#pragma once
#include <cstddef>
#include <vector>

#include "dynasurf/io/detail/dicom_stack.hpp"

namespace dynasurf::io {

// How the files of a folder become stacks.

/// Leaves the first file of every image; returns how many copies were dropped. Files of one UID that hold different
/// images stay, to be refused by name.
std::size_t drop_copies(std::vector<DicomImage>& images);

/// Files of several frames are stacks by themselves; files of one are put together by series, size and direction.
/// Throws InputError for gaps, doubles and missing files.
std::vector<DicomStack> stacks_of(const std::vector<DicomImage>& images);

}  // namespace dynasurf::io
