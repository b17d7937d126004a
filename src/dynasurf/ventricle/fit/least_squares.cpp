#include "dynasurf/ventricle/fit/least_squares.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/ventricle/fit/image_derivatives.hpp"

namespace dynasurf {
namespace {

struct GateMisfit {
  double data = 0;
  Eigen::VectorXd numbers;
  std::vector<float> weighted;  // residual times weight over noise
  Camera camera;
};

std::vector<float> picture(const BeatProblem& problem, const Eigen::VectorXd& gate, const Activity& activity,
                           const Camera& camera) {
  const GateLayout& layout = problem.layout.gate;
  std::vector<float> image = see(camera, activity.cells);
  const auto background = static_cast<float>(gate[layout.background]);
  for (float& v : image) v += background;
  for (int b = 0; b < layout.blob_count; ++b) {
    const auto amplitude = static_cast<float>(gate[layout.blobs + b]);
    const std::vector<float>& blob = problem.blobs[static_cast<std::size_t>(b)];
    for (std::size_t n = 0; n < image.size(); ++n) image[n] += amplitude * blob[n];
  }
  return image;
}

double dot(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += static_cast<double>(a[n] * b[n]);
  return sum;
}

GateMisfit look(const BeatProblem& problem, int g, const Eigen::VectorXd& unknowns, Misfit& result) {
  const auto at = static_cast<std::size_t>(g);
  GateMisfit gate;
  gate.numbers = problem.layout.at_gate(g, unknowns);
  gate.camera = make_camera(problem.cells.lattice, problem.pixels,
                            problem.sigma_mm * std::exp(gate.numbers[problem.layout.gate.width]), problem.filtered);
  result.activity[at] = lay_out(problem.cells, problem.layout.gate, gate.numbers);
  std::vector<float>& residual = result.residual[at];
  residual = picture(problem, gate.numbers, result.activity[at], gate.camera);
  gate.weighted.resize(residual.size());
  for (std::size_t n = 0; n < residual.size(); ++n) {
    residual[n] -= problem.values[at][n];
    gate.weighted[n] = residual[n] * problem.weight[n] / static_cast<float>(problem.noise);
    gate.data += 0.5 * static_cast<double>(residual[n] * gate.weighted[n]);
  }
  return gate;
}

/// Relative deviations of the muscle's volume from its mean, over what is allowed, and their derivatives by the
/// volumes.
struct WallCycle {
  Eigen::VectorXd deviation;
  Eigen::MatrixXd by_volume;  // [deviation][gate]
};
WallCycle wall_cycle(const BeatProblem& problem, const std::vector<Activity>& activity) {
  const auto gates = static_cast<Eigen::Index>(activity.size());
  double mean = 0;
  for (const Activity& a : activity) mean += a.wall_mm3 / static_cast<double>(gates);
  mean = std::max(mean, 1.0);
  WallCycle cycle{Eigen::VectorXd(gates), Eigen::MatrixXd(gates, gates)};
  for (Eigen::Index g = 0; g < gates; ++g) {
    const double share = activity[static_cast<std::size_t>(g)].wall_mm3 / mean;
    cycle.deviation[g] = (share - 1) / problem.wall_spread;
    for (Eigen::Index h = 0; h < gates; ++h)
      cycle.by_volume(g, h) = ((g == h ? 1 : 0) - share / static_cast<double>(gates)) / (mean * problem.wall_spread);
  }
  return cycle;
}

}  // namespace

Misfit misfit(const BeatProblem& problem, const Eigen::VectorXd& unknowns) {
  const BeatLayout& layout = problem.layout;
  const auto gates = static_cast<std::size_t>(layout.gates);
  Misfit result;
  result.residual.resize(gates);
  result.activity.resize(gates);
  std::vector<GateMisfit> looks(gates);
  parallel_for(gates, 1,
               [&](std::size_t g, std::size_t) { looks[g] = look(problem, static_cast<int>(g), unknowns, result); });
  const WallCycle cycle = wall_cycle(problem, result.activity);
  const Eigen::VectorXd by_wall = cycle.by_volume.transpose() * cycle.deviation;
  std::vector<Eigen::VectorXd> gradients(gates);
  parallel_for(gates, 1, [&](std::size_t g, std::size_t) {
    const GateMisfit& gate = looks[g];
    const GateLayout& numbers = layout.gate;
    const std::vector<float> by_cell = see_back(gate.camera, gate.weighted);
    gradients[g] = trace_back(problem.cells, numbers, gate.numbers, result.activity[g], by_cell, 0,
                              by_wall[static_cast<Eigen::Index>(g)]);
    for (const float w : gate.weighted) gradients[g][numbers.background] += static_cast<double>(w);
    for (int axis = 0; axis < 3; ++axis)
      gradients[g][numbers.width] += dot(gate.weighted, see(gate.camera, result.activity[g].cells, axis));
    for (int b = 0; b < numbers.blob_count; ++b)
      gradients[g][numbers.blobs + b] = dot(gate.weighted, problem.blobs[static_cast<std::size_t>(b)]);
  });
  const Eigen::VectorXd from_belief = (unknowns - layout.expected).cwiseQuotient(layout.spread);
  result.gradient = from_belief.cwiseQuotient(layout.spread);
  for (std::size_t g = 0; g < gates; ++g) {
    result.data += looks[g].data;
    layout.add_gradient(static_cast<int>(g), gradients[g], result.gradient);
  }
  result.value = result.data + 0.5 * from_belief.squaredNorm() + 0.5 * cycle.deviation.squaredNorm();
  return result;
}

NormalMatrix normal_matrix(const BeatProblem& problem, const Eigen::VectorXd& unknowns, const Misfit& at) {
  const BeatLayout& layout = problem.layout;
  const auto gates = static_cast<std::size_t>(layout.gates);
  std::vector<std::size_t> chosen;
  for (std::size_t n = 0; n < problem.weight.size(); ++n)
    if (problem.weight[n] > 0) chosen.push_back(n);
  std::vector<Eigen::MatrixXd> of_gate(gates);
  std::vector<Eigen::VectorXd> of_wall(gates);
  parallel_for(gates, 1, [&](std::size_t g, std::size_t) {
    const Eigen::VectorXd numbers = layout.at_gate(static_cast<int>(g), unknowns);
    ImageDerivatives derivatives = image_derivatives(problem, numbers, at.activity[g], chosen);
    for (std::size_t n = 0; n < chosen.size(); ++n)
      derivatives.row(static_cast<Eigen::Index>(n)) *= std::sqrt(problem.weight[chosen[n]]);
    Eigen::MatrixXf squares = Eigen::MatrixXf::Zero(derivatives.cols(), derivatives.cols());
    squares.selfadjointView<Eigen::Lower>().rankUpdate(derivatives.transpose());
    of_gate[g] = squares.selfadjointView<Eigen::Lower>().toDenseMatrix().cast<double>();
    of_wall[g] = trace_back(problem.cells, layout.gate, numbers, at.activity[g], {}, 0, 1);
  });
  NormalMatrix matrix{Eigen::MatrixXd::Zero(layout.unknowns, layout.unknowns),
                      layout.spread.cwiseAbs2().cwiseInverse().asDiagonal()};
  Eigen::MatrixXd walls = Eigen::MatrixXd::Zero(layout.unknowns, layout.gates);
  for (std::size_t g = 0; g < gates; ++g) {
    layout.add_hessian(static_cast<int>(g), of_gate[g], matrix.data);
    Eigen::VectorXd column = Eigen::VectorXd::Zero(layout.unknowns);
    layout.add_gradient(static_cast<int>(g), of_wall[g], column);
    walls.col(static_cast<Eigen::Index>(g)) = column;
  }
  const Eigen::MatrixXd deviations = walls * wall_cycle(problem, at.activity).by_volume.transpose();
  matrix.rest += deviations * deviations.transpose();
  return matrix;
}

void minimise(const BeatProblem& problem, Solution& solution, int most_steps, double tolerance,
              const Progress& progress) {
  constexpr int oldest = 5;
  constexpr double least_truth = 0.3;  // of the gain that the matrix predicts
  solution.misfit = misfit(problem, solution.unknowns);
  solution.converged = false;
  const auto renew = [&] { solution.matrix = normal_matrix(problem, solution.unknowns, solution.misfit); };
  if (solution.matrix.rest.rows() != solution.unknowns.size()) renew();
  double damping = 1e-3;
  for (int step = 0; step < most_steps; ++step) {
    progress.check();
    ++solution.steps;
    Eigen::MatrixXd damped = solution.matrix.whole(problem.noise);
    damped.diagonal() *= 1 + damping;
    const Eigen::VectorXd move = damped.selfadjointView<Eigen::Lower>().llt().solve(solution.misfit.gradient);
    const double predicted = 0.5 * move.dot(solution.misfit.gradient);
    Misfit next = misfit(problem, solution.unknowns - move);
    const double gain = solution.misfit.value - next.value;
    if (!(gain > 0)) {
      if (solution.matrix.age > 0)
        renew();
      else if ((damping = std::max(10 * damping, 1e-2)) > 1e6)
        break;
      continue;
    }
    solution.unknowns -= move;
    solution.misfit = std::move(next);
    damping = std::max(damping / 10, 1e-7);
    ++solution.matrix.age;
    if (gain < tolerance * solution.misfit.value) {
      solution.converged = true;
      break;
    }
    if (solution.matrix.age >= oldest || gain < least_truth * predicted) renew();
  }
}

}  // namespace dynasurf
