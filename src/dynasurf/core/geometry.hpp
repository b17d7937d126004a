#pragma once
#include <array>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace dynasurf {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Index3 = std::array<int, 3>;

}  // namespace dynasurf
