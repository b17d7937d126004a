#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dynasurf/io/detail/dicom_stack.hpp"

// What stacks of frames and stacks of files have in common: where their voxels are, and when their gates.
namespace dynasurf::io {

inline void note(Notes& notes, Severity severity, const char* code, const std::string& message) {
  notes.push_back({severity, code, message});
}

/// Axes of one image (unit vectors), size of a pixel in mm, centre of the first pixel.
struct Placement {
  Vec3 right, down, normal, origin;
  double column_mm, row_mm;
};

/// Throws InputError where the size of a pixel is not told; notes what else is absent.
Placement placement_of(const DicomImage& image, Notes& notes);

/// Signed distance between slices in mm: SpacingBetweenSlices, else the thickness, else the spacing within the slice.
/// `several`: notes what was taken for it.
double slice_spacing_of(const DicomImage& image, Notes& notes, bool several);

/// Times of the gates and the length of the beat from what the file says of its R-R interval number `rr`, from 1.
void set_gate_times(DicomStack& stack, const DicomImage& image, int rr);

/// The same from the gates' own trigger times in ms or percentages of the cycle.
void set_times_from(DicomStack& stack, const std::string& key, const std::vector<double>& values,
                    const DicomImage& image);

/// An attribute that differs from gate to gate.
struct GateKey {
  const char* name;
  std::function<std::optional<double>(const DicomImage&)> value;
};

/// The best first.
const std::vector<GateKey>& gate_keys();

}  // namespace dynasurf::io
