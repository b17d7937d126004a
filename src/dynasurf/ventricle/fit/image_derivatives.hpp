#pragma once
#include <vector>

#include <Eigen/Core>

#include "dynasurf/ventricle/fit/least_squares.hpp"

namespace dynasurf {

/// Derivatives of the image of one gate: a row per pixel of `chosen`, a column per number of the gate.
using ImageDerivatives = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
ImageDerivatives image_derivatives(const BeatProblem& problem, const Eigen::VectorXd& gate, const Activity& activity,
                                   const std::vector<std::size_t>& chosen);

}  // namespace dynasurf
