#pragma once
#include <vector>

#include <Eigen/Core>

#include "dynasurf/psf_fit/detail/beat_problem.hpp"
#include "dynasurf/psf_fit/detail/matrix_loops.hpp"

namespace dynasurf::psf_fit {

/// Directions that cover the heart as densely as the blur asks for, and their harmonics, a column each and a line each.
/// The same for all gates.
struct EvenRays {
  std::vector<Vec3> direction;
  Eigen::MatrixXd harmonics;
  detail::AlignedMatrix lines;
};
EvenRays even_rays(const BeatProblem& problem);

/// Sums over the pixels of `chosen`, by their weights, of products of the derivatives of one gate's image by two
/// numbers of the gate: a line per number, the lower triangle.
detail::AlignedMatrix squares_of_derivatives(const BeatProblem& problem, const EvenRays& rays, std::size_t g,
                                             const Eigen::VectorXd& gate, const Activity& activity,
                                             const std::vector<std::size_t>& chosen);

}  // namespace dynasurf::psf_fit
