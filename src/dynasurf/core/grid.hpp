#pragma once
#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "dynasurf/core/detail/rounding.hpp"

namespace dynasurf {

/// A point or vector in space: x, y, z.
using Vec3 = Eigen::Vector3d;
/// A rotation or another linear map of space.
using Mat3 = Eigen::Matrix3d;
/// A voxel: its place along i, j and k, from 0.
using Index3 = std::array<int, 3>;
/// A place in memory, or a step from one to another.
using Index = std::ptrdiff_t;

/// The number of voxels of a box of `dims`.
constexpr std::size_t size_of(const Index3& dims) {
  return dims[0] * static_cast<std::size_t>(dims[1]) * static_cast<std::size_t>(dims[2]);
}
/// Where a voxel of a box lies in memory, i fastest.
constexpr std::size_t index_in(const Index3& dims, const Index3& voxel) {
  return voxel[0] + dims[0] * (voxel[1] + dims[1] * static_cast<std::size_t>(voxel[2]));
}
/// The voxel at a place in memory: the inverse of `index_in`.
constexpr Index3 voxel_in(const Index3& dims, std::size_t index) {
  const std::size_t row = index / dims[0];
  return {static_cast<int>(index % dims[0]), static_cast<int>(row % dims[1]), static_cast<int>(row / dims[1])};
}

/// A box of voxels within a larger one.
struct VoxelBox {
  Index3 first{0, 0, 0}, count{0, 0, 0};
};

/// A lattice of voxels placed in the patient (VOL-WORLD, thesis 2.1).
///
/// Two frames are in use. The *world* is DICOM's LPS in mm. The *grid frame* is mm along the grid's own axes with
/// its origin at the centre of voxel (0,0,0): voxel (i,j,k) sits at (i dx, j dy, k dz). Fields, borders and particles
/// live in the grid frame; only files and reports speak of the world.
struct Grid {
  Index3 dims{0, 0, 0};               // voxels along i, j, k; i varies fastest in memory
  Vec3 spacing{1, 1, 1};              // mm between voxel centres, positive
  Vec3 origin{0, 0, 0};               // world position of the centre of voxel (0,0,0), mm
  Mat3 direction = Mat3::Identity();  // columns: world directions of i, j, k; orthonormal, the determinant may be -1

  std::size_t size() const { return size_of(dims); }
  std::size_t slice_size() const { return size_of({dims[0], dims[1], 1}); }
  std::size_t index(int i, int j, int k) const { return index_in(dims, {i, j, k}); }
  bool contains(int i, int j, int k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < dims[0] && j < dims[1] && k < dims[2];
  }
  double voxel_volume_mm3() const { return spacing.prod(); }
  bool operator==(const Grid& o) const {
    return dims == o.dims && spacing == o.spacing && origin == o.origin && direction == o.direction;
  }
};

/// Centre of a voxel in the grid frame, mm.
inline Vec3 centre_of(const Grid& g, const Index3& v) {
  return {v[0] * g.spacing[0], v[1] * g.spacing[1], v[2] * g.spacing[2]};
}

/// Voxel whose cell holds a point of the grid frame: floor(p/d + 1/2). May lie outside the grid.
inline Index3 voxel_of(const Grid& g, const Vec3& p) {
  const auto nearest = [&](int axis) { return floor_int(p[axis] / g.spacing[axis] + 0.5); };
  return {nearest(0), nearest(1), nearest(2)};
}

/// Both ways between the grid frame and the world (LPS), mm.
inline Vec3 to_world(const Grid& g, const Vec3& grid_mm) { return g.origin + g.direction * grid_mm; }
inline Vec3 to_grid(const Grid& g, const Vec3& world_mm) { return g.direction.transpose() * (world_mm - g.origin); }

}  // namespace dynasurf
