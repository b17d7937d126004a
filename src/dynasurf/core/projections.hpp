#pragma once
#include <cstddef>
#include <vector>

#include "dynasurf/core/geometry.hpp"

namespace dynasurf {

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
  std::size_t bins() const { return static_cast<std::size_t>(size) * static_cast<std::size_t>(size); }
};

}  // namespace dynasurf
