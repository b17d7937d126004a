#pragma once
#include <array>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace dynasurf {

/// A point or vector in space: x, y, z.
using Vec3 = Eigen::Vector3d;
/// A rotation or another linear map of space.
using Mat3 = Eigen::Matrix3d;
/// A voxel: its place along i, j and k, from 0.
using Index3 = std::array<int, 3>;

}  // namespace dynasurf
