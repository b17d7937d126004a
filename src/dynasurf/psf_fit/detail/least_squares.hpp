#pragma once
#include <vector>

#include <Eigen/Core>

#include "dynasurf/core/progress.hpp"
#include "dynasurf/psf_fit/detail/beat_problem.hpp"
#include "dynasurf/psf_fit/detail/cholesky.hpp"

namespace dynasurf::psf_fit {

/// How badly a set of unknowns explains the beat: half the sum of squares of the data, of the priors, of the points
/// that a person placed, and of the muscle's volume over the beat, each over its standard deviation.
struct Objective {
  double value = 0, data = 0;
  Eigen::VectorXd gradient;
  std::vector<std::vector<float>> residual;  // [gate][pixel] model less data
  std::vector<Activity> activity;            // [gate]
};
/// The objective and its gradient at some unknowns.
Objective objective(const BeatProblem& problem, const Eigen::VectorXd& unknowns);
/// The same without its gradient, which takes as long again, and the gradient there. Where the point spread is not
/// within a factor of three of its start, the value is infinite and the rest is empty.
Objective objective_value(const BeatProblem& problem, const Eigen::VectorXd& unknowns);
Eigen::VectorXd objective_gradient(const BeatProblem& problem, const Eigen::VectorXd& unknowns, const Objective& at);

/// The part of the priors in a Gauss-Newton matrix: a diagonal D and two products of a few columns, D + C C' + T T'.
struct PriorMatrix {
  Eigen::VectorXd diagonal;  // D, 1 / variance of each unknown's prior
  Eigen::MatrixXd cycle;     // C, [unknown][gate]: the muscle's volume against its mean over the beat
  Eigen::MatrixXd terms;     // T, [unknown][wall term]
};
/// Gauss-Newton matrix of the objective at some unknowns, in parts. That of the data is for a noise of 1; its
/// derivatives of the image are those of point sources on the walls. Only the lower triangles of `data` and `whole` are
/// set.
struct NormalMatrix {
  Eigen::MatrixXd data;
  PriorMatrix priors;
  int age = 0;  // steps taken since
  RowMatrix whole(double noise) const;
};
/// The part of the data from every n-th pixel, n = `every`, scaled up to all pixels.
Eigen::MatrixXd data_matrix(const BeatProblem& problem, const Eigen::VectorXd& unknowns, const Objective& at,
                            int every);
PriorMatrix prior_matrix(const BeatProblem& problem, const Eigen::VectorXd& unknowns, const Objective& at);

/// Where a minimisation stands.
struct Solution {
  Eigen::VectorXd unknowns;
  Objective objective;
  NormalMatrix matrix;   // of a step at or before the last
  int every = 1;         // a new matrix takes every n-th pixel
  double damping = 300;  // of the next step, in units of what is believed
  int steps = 0;
  bool converged = false;
};
/// Levenberg-Marquardt from where `solution` is: stops when a step gains less than `tolerance` of the misfit, or after
/// `most_steps` more. A matrix of the same unknowns is used on until it no longer predicts what a step gains.
void minimise(const BeatProblem& problem, Solution& solution, int most_steps, double tolerance,
              const Progress& progress);

}  // namespace dynasurf::psf_fit
