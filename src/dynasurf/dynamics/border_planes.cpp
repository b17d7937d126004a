#include "dynasurf/dynamics/detail/border_planes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dynasurf::dynamics {
namespace {

constexpr double least_cosine = 0.25;  // between path and normal; flatter paths would slide far along the plane

Vec3 vector_at(const field::VectorField& field, std::size_t voxel) {
  return {field.x[voxel], field.y[voxel], field.z[voxel]};
}

/// Length of the path inside the voxel.
double way_to_exit(const Grid& grid, const BorderHit& hit, const Vec3& unit) {
  const Vec3 centre = centre_of(grid, hit.voxel);
  double way = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a) {
    if (unit[a] == 0) continue;
    const double face = centre[a] + (unit[a] > 0 ? 0.5 : -0.5) * grid.spacing[a];
    way = std::min(way, (face - hit.entry[a]) / unit[a]);
  }
  return std::max(way, 0.0);
}

}  // namespace

Vec3 meeting_point(const Grid& grid, const BorderPlanes* planes, const BorderHit& hit, const Vec3& direction) {
  const double length = direction.norm();
  if (length == 0) return hit.entry;
  const Vec3 unit = direction / length;
  Vec3 point = centre_of(grid, hit.voxel), normal = unit;
  if (planes != nullptr) {
    const std::size_t voxel = grid.index(hit.voxel[0], hit.voxel[1], hit.voxel[2]);
    point += vector_at(planes->offset, voxel);
    const Vec3 known = vector_at(planes->normal, voxel);
    if (std::abs(known.dot(unit)) > least_cosine * known.norm()) normal = known;
  }
  const double way = normal.dot(point - hit.entry) / normal.dot(unit);
  return hit.entry + std::clamp(way, 0.0, way_to_exit(grid, hit, unit)) * unit;
}

}  // namespace dynasurf::dynamics
