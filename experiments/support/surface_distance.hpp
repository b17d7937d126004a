#pragma once
#include <cmath>

#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"

namespace dynasurf {

/// Mean distance in % of the diagonal of `truth`, of 50,000 points spread over one surface to the other, both ways.
inline double two_sided_percent(const TriMesh& mesh, const TriMesh& truth) {
  const auto one_way = [](const TriMesh& from, const TriMesh& to) {
    const mesh::ClosestPoint closest(to);
    double sum = 0;
    const PointCloud spread = synthetic::scan_surface(from, {.points = 50000});
    for (const Vec3& p : spread.points) sum += std::sqrt(closest(p).distance2) / 50000;
    return sum;
  };
  Eigen::AlignedBox3d box;
  for (const Vec3& p : truth.vertices) box.extend(p);
  return 50 * (one_way(mesh, truth) + one_way(truth, mesh)) / box.diagonal().norm();
}

}  // namespace dynasurf
