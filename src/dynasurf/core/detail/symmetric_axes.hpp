#pragma once
#include "dynasurf/core/grid.hpp"

namespace dynasurf {

/// The eigenvalues of a symmetric matrix, the smallest first, and their directions as the columns of a rotation.
struct SymmetricAxes {
  Vec3 values = Vec3::Zero();
  Mat3 directions = Mat3::Identity();
};

/// By Jacobi's rotations, to rounding error of the largest eigenvalue; directions that share a value are any pair at
/// right angles. Reads the upper triangle. What is not finite comes back as NaN. Only square roots and the four
/// operations, so the bytes are the same on every machine, which closed formulas with angles do not promise.
SymmetricAxes symmetric_axes(const Mat3&);

}  // namespace dynasurf
