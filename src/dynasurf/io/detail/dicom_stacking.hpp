#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dynasurf/io/detail/dicom_stack.hpp"

namespace dynasurf::io {

/// Why a file is not a reconstructed stack, and what to do about it; empty when it is one.
std::string reason_to_refuse(const DicomImage& image);

/// The stack within one file: frames are ordered by their vectors, never by position. `file` is its index. Throws
/// InputError when the vectors are of another length than the frames, or when a (gate, slice) pair is missing or
/// double.
DicomStack stack_of_frames(const DicomImage& image, std::size_t file);

/// The stack of single-frame files, one per slice (and gate): slices ordered along the normal, gates by the first
/// attribute that tells them apart. `files` are indices into `images`. Throws InputError for gaps, doubles and files
/// that are fewer than they say (see `require_all_images`).
DicomStack stack_of_slices(const std::vector<DicomImage>& images, std::span<const std::size_t> files);

/// Whether two grids hold the same voxels, to what their files tell of places.
bool is_same_grid(const Grid& a, const Grid& b);

/// One stack of several that hold a gate each, ordered by what tells the gates apart; nothing when they are not on
/// one grid or when no attribute says that they are gates of one beat.
std::optional<DicomStack> joined_gates(const std::vector<DicomImage>& images, std::span<const DicomStack> stacks);

}  // namespace dynasurf::io
