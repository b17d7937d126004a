#pragma once
#include <filesystem>
#include <span>

#include "dynasurf/core/study.hpp"

namespace dynasurf::io {

/// NIfTI-1 of whole numbers (uint8, intent LABEL), one volume per gate, placed and timed as `frame` is, on whose grid
/// they lie; gzip when the name ends in .gz. Whole or not at all. Throws InputError without a volume or for another
/// number of gates than the frame has, IoError.
void write_label_nifti(std::span<const Mask> gates, const Study& frame, const std::filesystem::path& path);

}  // namespace dynasurf::io
