#pragma once
#include <vector>

#include <Eigen/Core>

#include "dynasurf/ventricle/fit/least_squares.hpp"

namespace dynasurf {

/// Directions that cover the heart as densely as the blur asks for, and their harmonics, a column each. The same for
/// all gates.
struct EvenRays {
  std::vector<Vec3> direction;
  Eigen::MatrixXd harmonics;
};
EvenRays even_rays(const BeatProblem& problem);

/// Derivatives of the image of one gate: a row per pixel of `chosen`, a column per number of the gate.
using ImageDerivatives = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
ImageDerivatives image_derivatives(const BeatProblem& problem, const EvenRays& rays, const Eigen::VectorXd& gate,
                                   const Activity& activity, const std::vector<std::size_t>& chosen);

}  // namespace dynasurf
