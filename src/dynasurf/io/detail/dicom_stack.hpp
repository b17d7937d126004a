#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dynasurf/io/detail/dicom_file.hpp"

namespace dynasurf::io {

/// Positions are written with a few decimals; slices of hearts are millimetres apart.
inline constexpr double same_place_mm = 0.05;

/// One volume or a beat of volumes whose frames have found their places, before any pixel is read.
struct DicomStack {
  struct Frame {
    std::size_t file = 0;  // index into the images the stack was made from
    int frame = 0;         // 0-based within that file
  };

  Grid grid;
  int gates = 1;
  std::vector<Frame> frames;  // gate after gate, slice after slice
  std::vector<double> time_ms;
  double cycle_ms = 0;
  int declared_gates = 1;        // more than `gates` when this is one gate of a study of one file per gate
  std::optional<int> only_gate;  // then: which one, counted from 1, where the file says so
  Notes notes;

  std::size_t first_file() const { return frames.front().file; }
};

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

bool is_same_grid(const Grid& a, const Grid& b);

/// One stack of several that hold a gate each, ordered by what tells the gates apart; nothing when they are not on
/// one grid or when no attribute says that they are gates of one beat.
std::optional<DicomStack> joined_gates(const std::vector<DicomImage>& images, std::span<const DicomStack> stacks);

}  // namespace dynasurf::io
