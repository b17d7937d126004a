#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/grid.hpp"
#include "dynasurf/core/note.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf {

/// How the slices of a stack cut the heart.
enum class View { unknown, short_axis, horizontal_long_axis, vertical_long_axis, transaxial };
/// Which end of the ventricle comes first in a short-axis stack.
enum class SliceOrder { unknown, apex_to_base, base_to_apex };
/// What the reconstruction did about the photons that the body absorbs.
enum class Attenuation { unknown, uncorrected, corrected };

/// The word for it, as it stands in files; likewise for the order of slices and attenuation.
inline std::string_view name_of(View v) {
  constexpr std::string_view names[] = {"unknown", "short_axis", "horizontal_long_axis", "vertical_long_axis",
                                        "transaxial"};
  return names[static_cast<int>(v)];
}
inline std::string_view name_of(SliceOrder o) {
  constexpr std::string_view names[] = {"unknown", "apex_to_base", "base_to_apex"};
  return names[static_cast<int>(o)];
}
inline std::span<const std::string_view> names_of(Attenuation) {
  static constexpr std::array<std::string_view, 3> names{"unknown", "uncorrected", "corrected"};
  return names;
}
inline std::string_view name_of(Attenuation a) { return names_of(a)[static_cast<std::size_t>(a)]; }

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
  Attenuation attenuation = Attenuation::unknown;
  Notes notes;

  const Grid& grid() const { return gates.front().grid; }
  bool operator==(const Study&) const = default;
};

/// Width of what a collimated camera sees of a point: FWHM² = intrinsic² + (aperture + growth d)² at the distance d
/// from the collimator's face, all in mm.
struct CameraResponse {
  double intrinsic_mm = 0, aperture_mm = 0, growth = 0;
};

/// What a rotating camera with parallel holes counted: for each gate and view an image of `size` columns across the
/// patient and `size` rows along him. Looking from the front, columns run to the patient's left; rows run from his feet
/// to his head.
struct Projections {
  int size = 0;
  double bin_mm = 1;
  Vec3 centre{0, 0, 0};           // world point on the axis of rotation, level with the middle of the rows
  std::vector<double> angle_deg;  // per view: where the camera stands; 0 in front of the patient, 90 at his left
  std::vector<double> radius_mm;  // per view: from the axis of rotation to the collimator's face
  CameraResponse response;
  double cycle_ms = 0;                      // R-R interval; 0 when unknown
  std::vector<std::vector<float>> gates;    // per gate: views × rows × columns, columns fastest; counts
  std::vector<std::vector<float>> scatter;  // the same: what windows beside the peak say of the scatter in it

  std::size_t views() const { return angle_deg.size(); }
  std::size_t bins() const { return size_of({size, size, 1}); }
};

}  // namespace dynasurf
