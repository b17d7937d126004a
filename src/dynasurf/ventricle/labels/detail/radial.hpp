#pragma once
#include <vector>

#include "dynasurf/ventricle/labels/detail/circle.hpp"

namespace dynasurf::ventricle {

/// LAB-RADIAL (thesis 2.3.5) for one slice. `counts[m]` is the number of edge pixels whose distance from the axis is at
/// least m and less than m + 1 rings. A peak is a ring that holds more than `least_share` of the slice's edge pixels
/// and no fewer than its neighbours; of peaks closer than two rings the higher stays; those beyond the circle go.
struct RadialProfile {
  std::vector<int> counts;
  std::vector<double> peaks_px;  // mean distance of the pixels of each peak's ring, growing
};
RadialProfile radial_profile(const std::vector<image::Component>& edges, const Axis& axis, double circle_radius_px,
                             const RadialLabels& options);

}  // namespace dynasurf::ventricle
