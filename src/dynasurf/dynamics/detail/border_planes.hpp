#pragma once
#include "dynasurf/dynamics/detail/border_path.hpp"
#include "dynasurf/field/vector_field.hpp"

namespace dynasurf::dynamics {

/// Where the border runs inside its voxels, on the grid of the border volume: in each border voxel the plane through
/// the point `offset` (mm from the voxel's centre) with the normal `normal` (any length; zero where it is unknown).
/// Other voxels hold zeros.
struct BorderPlanes {
  field::VectorField offset, normal;

  BorderPlanes() = default;
  explicit BorderPlanes(const Grid& grid) : offset(grid), normal(grid) {}
};

/// The point at which a straight path that entered a border voxel meets the border in it (StopPoint::subvoxel): the
/// path's point on the voxel's plane. Where the normal is unknown or nearly across the path, or `planes` is null, the
/// point abreast of the border's point (of the voxel's centre). Always on the path and inside the voxel.
/// `direction` need not have unit length; a zero direction gives the entry.
Vec3 meeting_point(const Grid& grid, const BorderPlanes* planes, const BorderHit& hit, const Vec3& direction);

}  // namespace dynasurf::dynamics
