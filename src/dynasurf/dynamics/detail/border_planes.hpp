#pragma once
#include <cstddef>
#include <vector>

#include "dynasurf/dynamics/detail/border_path.hpp"

namespace dynasurf::dynamics {

/// Where the border runs inside one of its voxels (an index of the border volume): the plane through the point `offset`
/// (mm from the voxel's centre) with the normal `normal` (any length; zero where it is unknown).
struct BorderPlane {
  std::size_t voxel = 0;
  Eigen::Vector3f offset{0, 0, 0}, normal{0, 0, 0};
};

/// Planes of the voxels of a border volume with this grid, in ascending order of their voxels. A border has few voxels
/// beside its grid.
struct BorderPlanes {
  Grid grid;
  std::vector<BorderPlane> planes;
};

/// The plane of a voxel, all zeros where there is none.
BorderPlane plane_in(const BorderPlanes& border, std::size_t voxel);

/// The point at which a straight path that entered a border voxel meets the border in it (StopPoint::subvoxel): the
/// path's point on the voxel's plane. Where the normal is unknown or nearly across the path, or `planes` is null, the
/// point abreast of the border's point (of the voxel's centre). Always on the path and inside the voxel.
/// `direction` need not have unit length; a zero direction gives the entry.
Vec3 meeting_point(const Grid& grid, const BorderPlanes* planes, const BorderHit& hit, const Vec3& direction);

}  // namespace dynasurf::dynamics
