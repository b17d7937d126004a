#pragma once
#include <span>

#include "dynasurf/core/grid.hpp"

namespace dynasurf {

/// The mean of points; zero of none.
inline Vec3 mean_point(std::span<const Vec3> points) {
  const double count = points.size();
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / count;
  return mean;
}

}  // namespace dynasurf
