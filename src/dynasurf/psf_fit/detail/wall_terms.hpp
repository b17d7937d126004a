#pragma once
#include <vector>

#include <Eigen/Core>

#include "dynasurf/psf_fit/detail/beat_problem.hpp"
#include "dynasurf/psf_fit/detail/blur_options.hpp"
#include "dynasurf/psf_fit/detail/start.hpp"

namespace dynasurf::psf_fit {

/// What is known of the walls of one gate beside the image: how far they are from it, in standard deviations, and the
/// derivatives of that by the gate's numbers.
struct WallTerm {
  int gate = 0;
  double deviation = 0;
  Eigen::VectorXd by_number;
};
/// The prior of the thickness, then the points that a person placed. `gates`: the numbers of every gate.
std::vector<WallTerm> wall_terms(const BeatProblem& problem, const std::vector<Eigen::VectorXd>& gates);

/// The prior of the thickness, of the gate whose cavity is the largest at the start. Harmonics up to `degree`. A
/// thickness that is given is that of the wall above its apical third.
ThicknessPrior thickness_prior(const PlacedStart& start, int degree, const BlurFit& options);

/// Lets the prior take thickness across the walls of these numbers, as surfaces are measured; before it was that across
/// an ellipsoid, which is larger by a tenth.
void follow_slopes(const GateLayout& layout, const HeartFrame& frame, const Eigen::VectorXd& gate,
                   ThicknessPrior& prior);

/// The points of a start as the objective takes them. Throws OptionError where one is too near to the middle of the
/// heart or too far from it to lie on a wall.
std::vector<PlacedPoint> placed_points(const PlacedStart& start, int degree);

}  // namespace dynasurf::psf_fit
