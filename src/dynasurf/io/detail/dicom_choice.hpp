#pragma once
#include <string>
#include <vector>

#include "dynasurf/io/detail/dicom_stack.hpp"

namespace dynasurf::io {

// Which of the stacks that a folder holds is the study.

/// A stack, and the number by which the user can choose it.
struct DicomChoice {
  DicomStack stack;
  std::string series;  // what --series calls it, when the user chose; else empty
};

/// Stacks of a gate each become one where something tells their gates apart: all of the folder, else those of each
/// series, else those of rest and those of stress. A folder that holds a gated stack is left as it is. Throws
/// InputError when a gate is missing.
std::vector<DicomStack> with_joined_gates(const std::vector<DicomImage>& images, std::vector<DicomStack> stacks);

/// Whether a stack may be a gated short-axis one.
bool is_wanted(const DicomImage& image, const DicomStack& stack);

/// "8 gates of 64 x 64 x 20".
std::string size_in_words(int gates, const Index3& voxels);

/// Words and numbers only, none of the file's own text: "8 gates of 64 x 64 x 20, short axis, rest".
std::string description_of(const DicomImage& image, const DicomStack& stack);

/// The stack that a folder is meant to hold: the only one; the only gated one that is not a long axis or transaxial and
/// has at least three slices; of such on one grid that differ in their energy window, that of the photopeak. With
/// `series`, one of those of which it is the SeriesInstanceUID, the number in the list of an error (SeriesNumber where
/// all have one of their own), or a part of the SeriesDescription, in this order. Adds notes of what was left out.
/// Throws InputError that lists the stacks when none or more than one is left. `where` is the file or folder.
DicomChoice chosen_stack(const std::vector<DicomImage>& images, std::vector<DicomStack> stacks,
                         const std::string& series, const std::string& where);

}  // namespace dynasurf::io
