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

}  // namespace dynasurf::io
