#pragma once
#include <string>

namespace dynasurf::io {

/// Whether a file starts like DICOM: with its preamble, or bare.
enum class DicomLook { none, bare, preamble };

/// Of the first 132 bytes of a file, or of all that it has.
inline DicomLook dicom_look_of(const std::string& head) {
  if (head.size() == 132 && head.compare(128, 4, "DICM") == 0) return DicomLook::preamble;
  if (head.size() < 8) return DicomLook::none;
  // The first element of a file without preamble belongs to group 2 or 8, and its group is a number of two bytes.
  const auto is_group = [&](char high, char low) { return high == 0 && (low == 2 || low == 8); };
  return is_group(head[1], head[0]) || is_group(head[0], head[1]) ? DicomLook::bare : DicomLook::none;
}

}  // namespace dynasurf::io
