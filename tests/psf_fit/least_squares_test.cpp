#include "dynasurf/psf_fit/detail/least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stop_token>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/psf_fit/detail/harmonics.hpp"

#include "psf_fit/round_heart.hpp"

namespace dynasurf::psf_fit {
namespace {

using test::noise;
using test::round_heart;
using test::RoundHeart;

/// The round heart as two gates look at it, off the truth in every number.
BeatProblem round_problem(Eigen::VectorXd& unknowns) {
  const RoundHeart heart = round_heart();
  BeatProblem problem;
  problem.cells = heart.cells;
  problem.pixels.count = {10, 10, 10};
  problem.pixels.spacing = {8, 8, 8};
  for (Vec3* corner : {&problem.cells.lattice.start, &problem.cells.frame.centre}) *corner += Vec3::Constant(36);
  problem.sigma_mm = 5;
  problem.noise = 0.01;
  problem.values = {noise(1000, 5), noise(1000, 6)};
  problem.weight.assign(1000, 1.0F);
  problem.thickness.harmonics.resize(5, harmonics_up_to(3));
  std::vector<double> row(static_cast<std::size_t>(harmonics_up_to(3)));
  for (int n = 0; n < 5; ++n) {
    real_spherical_harmonics(fibonacci_direction(n, 10), 3, row);
    problem.thickness.harmonics.row(n) = Eigen::Map<Eigen::RowVectorXd>(row.data(), harmonics_up_to(3));
  }
  problem.thickness.mm_per_q = Eigen::VectorXd::Constant(5, 25);
  problem.thickness.mean_mm = 8;
  for (const bool is_outer : {false, true}) {
    real_spherical_harmonics(fibonacci_direction(is_outer ? 2 : 4, 10), 3, row);
    problem.points.push_back({Eigen::Map<Eigen::RowVectorXd>(row.data(), harmonics_up_to(3)), is_outer ? 1 : 0,
                              is_outer, is_outer ? 0.3 : -0.1, 0.05});
  }
  Priors beliefs;
  beliefs.width = 0.1, beliefs.stretch = 0.15;
  Eigen::VectorXd other = heart.gate;
  other[heart.layout.endo] -= 0.2, other[heart.layout.wall] += 0.1, other[heart.layout.plane] -= 3;
  problem.layout = make_beat_layout(heart.layout, {heart.gate, other}, beliefs, unknowns);
  for (Eigen::Index n = 0; n < unknowns.size(); ++n) unknowns[n] += 0.05 * std::sin(static_cast<double>(7 * n));
  return problem;
}

TEST(Objective, GradientIsThatOfFiniteDifferences) {
  Eigen::VectorXd unknowns;
  const BeatProblem problem = round_problem(unknowns);
  const Eigen::VectorXd gradient = objective(problem, unknowns).gradient;
  const double size = gradient.cwiseProduct(problem.layout.spread).cwiseAbs().maxCoeff();
  for (Eigen::Index n = 0; n < unknowns.size(); ++n) {
    const double step = 1e-2 * problem.layout.spread[n];
    Eigen::VectorXd more = unknowns, less = unknowns;
    more[n] += step, less[n] -= step;
    const double difference = (objective(problem, more).value - objective(problem, less).value) / (2 * step);
    // Single precision: sums of a thousand pixels are good to about 1e-5 of themselves.
    EXPECT_NEAR(gradient[n] * problem.layout.spread[n], difference * problem.layout.spread[n], 2e-3 * size) << n;
  }
}

TEST(Objective, IsInfiniteWhereThePointSpreadIsOutOfReach) {
  Eigen::VectorXd unknowns;
  const BeatProblem problem = round_problem(unknowns);
  const int width = problem.layout.terms[0][problem.layout.gate.width].front().unknown;
  for (const double log_width : {1.3, 40.0, -2.0, std::nan("")}) {
    unknowns[width] = log_width;
    EXPECT_EQ(objective_value(problem, unknowns).value, std::numeric_limits<double>::infinity()) << log_width;
  }
}

/// The problem whose data are what the model itself makes of some unknowns.
BeatProblem solved_problem(Eigen::VectorXd& truth) {
  BeatProblem problem = round_problem(truth);
  truth = problem.layout.expected;
  for (Eigen::Index n = 0; n < truth.size(); ++n)
    truth[n] += 0.3 * problem.layout.spread[n] * std::sin(static_cast<double>(5 * n));
  for (std::vector<float>& gate : problem.values) gate.assign(gate.size(), 0.0F);
  problem.values = objective_value(problem, truth).residual;
  problem.noise = 1e-4;
  return problem;
}

TEST(DataMatrix, IsTheProductOfTheDerivativesOfTheImage) {
  Eigen::VectorXd unknowns;
  BeatProblem problem = round_problem(unknowns);
  for (std::size_t n = 0; n < problem.weight.size(); n += 3) problem.weight[n] = 0.25F;
  const Objective at = objective_value(problem, unknowns);
  Eigen::MatrixXd by_unknown(2000, unknowns.size());
  for (Eigen::Index n = 0; n < unknowns.size(); ++n) {
    const double step = 1e-2 * problem.layout.spread[n];
    Eigen::VectorXd more = unknowns, less = unknowns;
    more[n] += step, less[n] -= step;
    const Objective above = objective_value(problem, more), below = objective_value(problem, less);
    for (std::size_t g = 0; g < 2; ++g)
      for (std::size_t p = 0; p < 1000; ++p)
        by_unknown(static_cast<Eigen::Index>(1000 * g + p), n) =
            std::sqrt(static_cast<double>(problem.weight[p])) *
            static_cast<double>(above.residual[g][p] - below.residual[g][p]) / (2 * step);
  }
  const Eigen::MatrixXd expected = by_unknown.transpose() * by_unknown;
  const Eigen::MatrixXd matrix = data_matrix(problem, unknowns, at, 1);
  // Point sources on the walls stand for the cells near them, which are as large as a quarter of a pixel here.
  double worst = 0, sum = 0;
  for (Eigen::Index i = 0; i < unknowns.size(); ++i)
    for (Eigen::Index j = 0; j <= i; ++j) {
      const double off = std::abs(matrix(i, j) - expected(i, j)) / std::sqrt(expected(i, i) * expected(j, j));
      worst = std::max(worst, off);
      sum += off;
    }
  EXPECT_LT(worst, 0.25);
  EXPECT_LT(sum / static_cast<double>(unknowns.size() * (unknowns.size() + 1) / 2), 0.03);
}

TEST(DataMatrix, OfSomePixelsStandsForThatOfAll) {
  Eigen::VectorXd unknowns;
  const BeatProblem problem = round_problem(unknowns);
  const Objective at = objective_value(problem, unknowns);
  const Eigen::MatrixXd all = data_matrix(problem, unknowns, at, 1), half = data_matrix(problem, unknowns, at, 2);
  for (Eigen::Index n = 0; n < unknowns.size(); ++n) EXPECT_NEAR(half(n, n) / all(n, n), 1, 0.3) << n;
}

TEST(DataMatrix, OfEveryOtherPixelIsThatOfAllOnceTheImageIsBlurred) {
  Eigen::VectorXd unknowns;
  BeatProblem problem = round_problem(unknowns);
  problem.sigma_mm = 0.9 * problem.pixels.spacing[0];  // as pixels are joined
  const Objective at = objective_value(problem, unknowns);
  const Eigen::MatrixXd all = data_matrix(problem, unknowns, at, 1), half = data_matrix(problem, unknowns, at, 2);
  double worst = 0;
  for (Eigen::Index n = 0; n < unknowns.size(); ++n) worst = std::max(worst, std::abs(half(n, n) / all(n, n) - 1));
  EXPECT_LT(worst, 0.02);
}

TEST(PriorMatrix, HoldsTheSpreadsOfThePriors) {
  Eigen::VectorXd unknowns;
  const BeatProblem problem = round_problem(unknowns);
  const PriorMatrix priors = prior_matrix(problem, unknowns, objective_value(problem, unknowns));
  EXPECT_EQ(priors.diagonal, problem.layout.spread.cwiseAbs2().cwiseInverse());
  ASSERT_EQ(priors.cycle.rows(), unknowns.size());
  ASSERT_EQ(priors.cycle.cols(), problem.layout.gates);
  // Deviations from a mean add up to nothing.
  EXPECT_GT(priors.cycle.norm(), 0);
  EXPECT_LT(priors.cycle.rowwise().sum().norm(), 1e-9 * priors.cycle.norm());
  // What the muscle's volume and thickness add is a sum of squares.
  const Eigen::MatrixXd nothing = Eigen::MatrixXd::Zero(unknowns.size(), unknowns.size());
  const Eigen::MatrixXd matrix = NormalMatrix{nothing, priors}.whole(1).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd spreads = priors.diagonal.asDiagonal();
  const Eigen::MatrixXd rest = matrix - spreads;
  const double least = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(rest).eigenvalues().minCoeff();
  EXPECT_GT(least, -1e-9 * matrix.cwiseAbs().maxCoeff());
  EXPECT_GT(rest.trace(), 0);
}

TEST(NormalMatrix, IsTheSumOfItsParts) {
  constexpr Eigen::Index count = 75;  // no multiple of the rows that are done together
  std::srand(1);
  const Eigen::MatrixXd data = Eigen::MatrixXd::Random(count, count), cycle = Eigen::MatrixXd::Random(count, 9),
                        terms = Eigen::MatrixXd::Random(count, 2);
  const Eigen::VectorXd diagonal = Eigen::VectorXd::Random(count);
  const RowMatrix whole = NormalMatrix{data, {diagonal, cycle, terms}}.whole(0.25);
  Eigen::MatrixXd expected = 4 * data + cycle * cycle.transpose() + terms * terms.transpose();
  expected.diagonal() += diagonal;
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) EXPECT_NEAR(whole(i, j), expected(i, j), 1e-12) << i << ' ' << j;
}

TEST(Minimise, FindsTheUnknownsThatMadeTheImage) {
  Eigen::VectorXd truth;
  const BeatProblem problem = solved_problem(truth);
  Solution solution;
  solution.unknowns = problem.layout.expected;
  const double before = objective_value(problem, solution.unknowns).value,
               at_truth = objective_value(problem, truth).value;
  minimise(problem, solution, 60, 1e-4, {});
  EXPECT_TRUE(solution.converged);
  // The priors move the minimum off the truth, and below it.
  EXPECT_LT(solution.objective.value, at_truth);
  EXPECT_LT(solution.objective.value, 0.01 * before);
  const Eigen::VectorXd gradient = objective_gradient(problem, solution.unknowns, solution.objective);
  const Eigen::VectorXd at_start =
      objective_gradient(problem, problem.layout.expected, objective_value(problem, problem.layout.expected));
  EXPECT_LT(gradient.cwiseProduct(problem.layout.spread).norm(),
            0.02 * at_start.cwiseProduct(problem.layout.spread).norm());
  const double endo = problem.layout.at_gate(0, solution.unknowns)[problem.layout.gate.endo];
  EXPECT_NEAR(endo, problem.layout.at_gate(0, truth)[problem.layout.gate.endo], 0.01);
}

TEST(Minimise, NeverStepsUphillAndStopsAfterItsSteps) {
  Eigen::VectorXd unknowns;
  const BeatProblem problem = round_problem(unknowns);
  Solution solution;
  solution.unknowns = unknowns;
  double former = objective_value(problem, unknowns).value;
  for (int steps = 1; steps <= 4; ++steps) {
    minimise(problem, solution, 1, 0, {});
    EXPECT_EQ(solution.steps, steps);
    EXPECT_FALSE(solution.converged);
    EXPECT_LE(solution.objective.value, former);
    EXPECT_EQ(solution.objective.value, objective_value(problem, solution.unknowns).value);
    former = solution.objective.value;
  }
}

TEST(Minimise, EndsWhenItIsStopped) {
  Eigen::VectorXd unknowns;
  const BeatProblem problem = round_problem(unknowns);
  Solution solution;
  solution.unknowns = unknowns;
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(minimise(problem, solution, 10, 1e-3, {{}, stop.get_token()}), Cancelled);
  EXPECT_EQ(solution.unknowns, unknowns);
}

}  // namespace
}  // namespace dynasurf::psf_fit
