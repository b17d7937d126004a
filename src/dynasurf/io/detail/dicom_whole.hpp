#pragma once
#include <span>
#include <string>
#include <vector>

#include "dynasurf/io/detail/dicom_file.hpp"

namespace dynasurf::io {

// Whether a stack of single-frame files lacks some of them: what a transfer that was cut short leaves behind.

/// Throws InputError, naming the place, unless the heights of the slices (mm, ascending) are equally far apart.
/// Precondition: two or more.
void require_even_slices(std::span<const double> heights, const std::string& folder);

/// Throws InputError when the files are fewer than they say of themselves: by NumberOfSlices (as `slices`), by
/// NumberOfTimeSlots (as `gates`, where there are several) or by ImagesInAcquisition. Derived images copy such counts
/// from those they were made from, so there a note tells instead; another one tells of numbers that do not start at 1.
/// A last slice that no count tells of is not missed by anybody.
void require_all_images(const std::vector<DicomImage>& images, std::span<const std::size_t> files, std::size_t slices,
                        std::size_t gates, Notes& notes);

}  // namespace dynasurf::io
