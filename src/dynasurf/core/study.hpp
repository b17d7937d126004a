#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf {

/// How the slices of a stack cut the heart.
enum class View { unknown, short_axis, horizontal_long_axis, vertical_long_axis, transaxial };
/// Which end of the ventricle comes first in a short-axis stack.
enum class SliceOrder { unknown, apex_to_base, base_to_apex };

/// The word for it, as it stands in files; likewise for the order of slices.
inline std::string_view name_of(View v) {
  constexpr std::string_view names[] = {"unknown", "short_axis", "horizontal_long_axis", "vertical_long_axis",
                                        "transaxial"};
  return names[static_cast<int>(v)];
}
inline std::string_view name_of(SliceOrder o) {
  constexpr std::string_view names[] = {"unknown", "apex_to_base", "base_to_apex"};
  return names[static_cast<int>(o)];
}

/// A heart study as read: one volume per gate (one volume: ungated), all on the same grid, values as stored after
/// rescaling, slices in the order of the file. Holds nothing that identifies a person.
struct Study {
  std::vector<Image> gates;
  std::vector<double> time_ms;  // start of each gate after the R wave; empty when unknown, else one per gate
  double cycle_ms = 0;          // R-R interval; 0 when unknown
  std::string format;           // "DICOM", "NIfTI", "NRRD", or "synthetic"
  std::string modality;         // DICOM's word: NM, PT, MR, CT; empty when the format has none
  std::string image_type;       // value 3 of DICOM's ImageType, for example RECON GATED TOMO; else empty
  std::string series;           // the number of the image series, where the user chose one of several; else empty
  View view = View::unknown;
  SliceOrder slice_order = SliceOrder::unknown;
  Notes notes;

  const Grid& grid() const { return gates.front().grid; }
};

}  // namespace dynasurf
