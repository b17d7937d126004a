#pragma once
#include <span>

#include "dynasurf/core/grid.hpp"

namespace dynasurf::cloud {

/// How fast the number of points within a distance of a point grows with the distance, as a power: near 1 along a
/// curve, near 2 on a surface, near 3 where points fill space (correlation dimension, Grassberger and Procaccia 1983).
/// The smallest at any distance from that of a few neighbours to half the mean distance from the middle: noise fills
/// space only nearby, and two sides of a wall only where it is thin. 0 where there are too few points to tell.
double smallest_dimension(std::span<const Vec3> points);

}  // namespace dynasurf::cloud
