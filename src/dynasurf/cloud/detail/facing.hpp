#pragma once
#include <array>
#include <cmath>

#include "dynasurf/cloud/detail/kd_tree.hpp"

namespace dynasurf::cloud {

/// The other side of a wall says nothing of a place; an edge that the surface turns around does.
inline constexpr double not_against = -0.5;  // cosine

/// Distance to the nearest of the points around a place whose direction, which `facing` tells by number, has a cosine
/// above `least` to the normal there; `most` when none nearer than that has.
template <class Facing>
double distance_facing(const KdTree& tree, const Vec3& place, const Vec3& normal, double least, double most,
                       const Facing& facing) {
  const KdTree::Found first = tree.nearest(place, most);
  if (!(first.distance2 < most * most)) return most;
  if (facing(first.index).dot(normal) > least) return std::sqrt(first.distance2);
  std::array<KdTree::Found, 16> found;
  const std::size_t count = tree.nearest(place, found, most);
  for (std::size_t k = 0; k < count; ++k)
    if (facing(found[k].index).dot(normal) > least) return std::sqrt(found[k].distance2);
  return most;
}

}  // namespace dynasurf::cloud
