#pragma once
#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

namespace dynasurf {

/// A point or vector in space: x, y, z.
using Vec3 = Eigen::Vector3d;
/// A rotation or another linear map of space.
using Mat3 = Eigen::Matrix3d;
/// A voxel: its place along i, j and k, from 0.
using Index3 = std::array<int, 3>;

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

  std::size_t size() const { return dims[0] * static_cast<std::size_t>(dims[1]) * static_cast<std::size_t>(dims[2]); }
  std::size_t index(int i, int j, int k) const { return i + dims[0] * (j + dims[1] * static_cast<std::size_t>(k)); }
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
  return {static_cast<int>(std::floor(p[0] / g.spacing[0] + 0.5)),
          static_cast<int>(std::floor(p[1] / g.spacing[1] + 0.5)),
          static_cast<int>(std::floor(p[2] / g.spacing[2] + 0.5))};
}

/// Both ways between the grid frame and the world (LPS), mm.
inline Vec3 to_world(const Grid& g, const Vec3& grid_mm) { return g.origin + g.direction * grid_mm; }
inline Vec3 to_grid(const Grid& g, const Vec3& world_mm) { return g.direction.transpose() * (world_mm - g.origin); }

}  // namespace dynasurf
