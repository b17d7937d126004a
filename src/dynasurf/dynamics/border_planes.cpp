#include "dynasurf/dynamics/detail/border_planes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dynasurf::dynamics {
namespace {

constexpr double least_cosine = 0.25;  // between path and normal; flatter paths would slide far along the plane

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

BorderPlane plane_in(const BorderPlanes& border, std::size_t voxel) {
  const auto found = std::lower_bound(border.planes.begin(), border.planes.end(), voxel,
                                      [](const BorderPlane& plane, std::size_t v) { return plane.voxel < v; });
  return found != border.planes.end() && found->voxel == voxel ? *found : BorderPlane{};
}

Vec3 meeting_point(const Grid& grid, const BorderPlanes* planes, const BorderHit& hit, const Vec3& direction) {
  const double length = direction.norm();
  if (length == 0) return hit.entry;
  const Vec3 unit = direction / length;
  Vec3 point = centre_of(grid, hit.voxel), normal = unit;
  if (planes != nullptr) {
    const BorderPlane plane = plane_in(*planes, grid.index(hit.voxel[0], hit.voxel[1], hit.voxel[2]));
    point += plane.offset.cast<double>();
    const Vec3 known = plane.normal.cast<double>();
    if (std::abs(known.dot(unit)) > least_cosine * known.norm()) normal = known;
  }
  const double way = normal.dot(point - hit.entry) / normal.dot(unit);
  return hit.entry + std::clamp(way, 0.0, way_to_exit(grid, hit, unit)) * unit;
}

}  // namespace dynasurf::dynamics
