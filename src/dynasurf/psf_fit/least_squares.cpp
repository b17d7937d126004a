#include "dynasurf/psf_fit/detail/least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/trace.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/psf_fit/detail/harmonics.hpp"
#include "dynasurf/psf_fit/detail/image_derivatives.hpp"
#include "dynasurf/psf_fit/detail/matrix_loops.hpp"
#include "dynasurf/psf_fit/detail/wall_terms.hpp"

namespace dynasurf::psf_fit {
namespace {

void add_scaled(std::vector<float>& image, double amplitude, const std::vector<float>& other) {
  const float factor = amplitude;
  for (std::size_t n = 0; n < image.size(); ++n) image[n] += factor * other[n];
}

std::vector<float> picture(const BeatProblem& problem, std::size_t g, const Eigen::VectorXd& gate,
                           const Activity& activity, const PsfProjector& camera) {
  const GateLayout& layout = problem.layout.gate;
  std::vector<float> image = project(camera, activity.cells);
  const float background = gate[layout.background];
  for (float& v : image) v += background;
  for (int k = 0; k < layout.attenuation_count; ++k)
    add_scaled(image, gate[layout.attenuation + k], problem.attenuation[k][g]);
  for (int b = 0; b < layout.blob_count; ++b) add_scaled(image, gate[layout.blobs + b], problem.blobs[b]);
  return image;
}

double dot(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += a[n] * b[n];
  return sum;
}

/// The width of the point spread is the same in all gates.
PsfProjector camera_of(const BeatProblem& problem, const std::vector<Eigen::VectorXd>& gates) {
  return make_camera(problem.cells.lattice, problem.pixels, point_spread(problem, gates.front()), problem.filtered);
}

/// Residual times weight over noise.
float weighted(const BeatProblem& problem, const std::vector<float>& residual, std::size_t n) {
  const float noise = problem.noise;
  return residual[n] * problem.weight[n] / noise;
}

/// Relative deviations of the muscle's volume from its mean, over what is allowed, and their derivatives by the
/// volumes.
struct WallCycle {
  Eigen::VectorXd deviation;
  Eigen::MatrixXd by_volume;  // [deviation][gate]
};
WallCycle wall_cycle(const BeatProblem& problem, const std::vector<Activity>& activity) {
  const Eigen::Index gates = activity.size();
  double mean = 0;
  for (const Activity& a : activity) mean += a.wall_mm3 / gates;
  mean = std::max(mean, 1.0);
  WallCycle cycle{Eigen::VectorXd(gates), Eigen::MatrixXd(gates, gates)};
  for (Eigen::Index g = 0; g < gates; ++g) {
    const double share = activity[g].wall_mm3 / mean;
    cycle.deviation[g] = (share - 1) / problem.wall_relative_sd;
    for (Eigen::Index h = 0; h < gates; ++h)
      cycle.by_volume(g, h) = ((g == h ? 1 : 0) - share / gates) / (mean * problem.wall_relative_sd);
  }
  return cycle;
}

/// A step may lead to a point spread wider than the heart, whose kernels would take minutes.
bool is_within_reach(const BeatLayout& layout, const Eigen::VectorXd& gate) {
  constexpr double farthest = 1.1;  // of the logs of the widths over their start: a factor of three
  return (log_widths * gate.segment<3>(layout.gate.width)).cwiseAbs().maxCoeff() <= farthest;
}

Eigen::MatrixXd symmetric(const detail::AlignedMatrix& lower, int count, double scale) {
  Eigen::MatrixXd whole(count, count);
  for (int i = 0; i < count; ++i)
    for (int j = 0; j <= i; ++j) whole(i, j) = whole(j, i) = scale * lower.line(i)[j];
  return whole;
}

}  // namespace

Objective objective_value(const BeatProblem& problem, const Eigen::VectorXd& unknowns) {
  const TraceStage noted("fit: objective");
  const BeatLayout& layout = problem.layout;
  const std::size_t gates = layout.gates;
  Objective result;
  const std::vector<Eigen::VectorXd> numbers = layout.at_gates(unknowns);
  if (!is_within_reach(layout, numbers.front())) {
    result.value = std::numeric_limits<double>::infinity();
    return result;
  }
  result.residual.resize(gates);
  result.activity.resize(gates);
  const PsfProjector camera = camera_of(problem, numbers);
  const CellFields fields = fields_of(problem.cells, layout.gate, numbers);
  std::vector<double> data(gates, 0.0);
  parallel_for(gates, 1, [&](std::size_t g, std::size_t) {
    result.activity[g] = rasterise(problem.cells, layout.gate, numbers[g], fields, g);
    std::vector<float>& residual = result.residual[g];
    residual = picture(problem, g, numbers[g], result.activity[g], camera);
    for (std::size_t n = 0; n < residual.size(); ++n) {
      residual[n] -= problem.values[g][n];
      data[g] += 0.5 * (residual[n] * weighted(problem, residual, n));
    }
  });
  for (const double of_gate : data) result.data += of_gate;
  result.value = result.data + 0.5 * (unknowns - layout.expected).cwiseQuotient(layout.spread).squaredNorm() +
                 0.5 * wall_cycle(problem, result.activity).deviation.squaredNorm();
  for (const WallTerm& term : wall_terms(problem, numbers)) result.value += 0.5 * term.deviation * term.deviation;
  return result;
}

Eigen::VectorXd objective_gradient(const BeatProblem& problem, const Eigen::VectorXd& unknowns, const Objective& at) {
  const TraceStage noted("fit: gradient");
  const BeatLayout& layout = problem.layout;
  const GateLayout& places = layout.gate;
  const std::size_t gates = layout.gates;
  const std::vector<Eigen::VectorXd> numbers = layout.at_gates(unknowns);
  const PsfProjector camera = camera_of(problem, numbers);
  const WallCycle cycle = wall_cycle(problem, at.activity);
  const Eigen::VectorXd by_wall = cycle.by_volume.transpose() * cycle.deviation;
  CellGradients to_cells = no_gradients(problem.cells, places, gates);
  parallel_for(gates, 1, [&](std::size_t g, std::size_t) {
    std::vector<float> by_pixel(at.residual[g].size());
    for (std::size_t n = 0; n < by_pixel.size(); ++n) by_pixel[n] = weighted(problem, at.residual[g], n);
    backpropagate_to_cells(problem.cells, places, numbers[g], at.activity[g], backproject(camera, by_pixel), 0,
                           by_wall[g], to_cells, g);
    Eigen::VectorXd& others = to_cells.others[g];
    for (const float w : by_pixel) others[places.background] += w;
    const auto by_widths = project_by_widths(camera, at.activity[g].cells);
    others.segment<3>(places.width) =
        log_widths.transpose() *
        Vec3(dot(by_pixel, by_widths[0]), dot(by_pixel, by_widths[1]), dot(by_pixel, by_widths[2]));
    for (int k = 0; k < places.attenuation_count; ++k)
      others[places.attenuation + k] = dot(by_pixel, problem.attenuation[k][g]);
    for (int b = 0; b < places.blob_count; ++b) others[places.blobs + b] = dot(by_pixel, problem.blobs[b]);
  });
  const std::vector<Eigen::VectorXd> gradients = gather(problem.cells, places, to_cells);
  Eigen::VectorXd gradient = (unknowns - layout.expected).cwiseQuotient(layout.spread).cwiseQuotient(layout.spread);
  for (std::size_t g = 0; g < gates; ++g) layout.add_gradient(g, gradients[g], gradient);
  for (const WallTerm& term : wall_terms(problem, numbers))
    layout.add_gradient(term.gate, term.deviation * term.by_number, gradient);
  return gradient;
}

Objective objective(const BeatProblem& problem, const Eigen::VectorXd& unknowns) {
  Objective result = objective_value(problem, unknowns);
  result.gradient = objective_gradient(problem, unknowns, result);
  return result;
}

Eigen::MatrixXd data_matrix(const BeatProblem& problem, const Eigen::VectorXd& unknowns, const Objective& at,
                            int every) {
  const BeatLayout& layout = problem.layout;
  const Index3& count = problem.pixels.count;
  const std::size_t gates = layout.gates;
  std::vector<std::size_t> chosen;
  std::size_t n = 0;
  for (int k = 0; k < count[2]; ++k)
    for (int j = 0; j < count[1]; ++j)
      for (int i = 0; i < count[0]; ++i, ++n)
        // In diagonal planes, so that no row and no column is left out.
        if (problem.weight[n] > 0 && (i + j + k) % every == 0) chosen.push_back(n);
  const EvenRays rays = even_rays(problem);
  std::vector<Eigen::MatrixXd> of_gate(gates);
  parallel_for(gates, 1, [&](std::size_t g, std::size_t) {
    const Eigen::VectorXd numbers = layout.at_gate(g, unknowns);
    of_gate[g] = symmetric(squares_of_derivatives(problem, rays, g, numbers, at.activity[g], chosen),
                           layout.gate.count(), every);
  });
  return layout.hessian(of_gate);
}

PriorMatrix prior_matrix(const BeatProblem& problem, const Eigen::VectorXd& unknowns, const Objective& at) {
  const BeatLayout& layout = problem.layout;
  const std::size_t gates = layout.gates;
  std::vector<Eigen::VectorXd> of_wall(gates);
  parallel_for(gates, 1, [&](std::size_t g, std::size_t) {
    const Eigen::VectorXd numbers = layout.at_gate(g, unknowns);
    of_wall[g] = backpropagate(problem.cells, layout.gate, numbers, at.activity[g], {}, 0, 1);
  });
  Eigen::MatrixXd walls = Eigen::MatrixXd::Zero(layout.unknowns, layout.gates);
  for (std::size_t g = 0; g < gates; ++g) {
    Eigen::VectorXd column = Eigen::VectorXd::Zero(layout.unknowns);
    layout.add_gradient(g, of_wall[g], column);
    walls.col(g) = column;
  }
  const std::vector<WallTerm> terms = wall_terms(problem, layout.at_gates(unknowns));
  PriorMatrix priors{layout.spread.cwiseAbs2().cwiseInverse(),
                     product(walls, wall_cycle(problem, at.activity).by_volume.transpose()),
                     Eigen::MatrixXd::Zero(layout.unknowns, terms.size())};
  for (std::size_t t = 0; t < terms.size(); ++t) {
    Eigen::VectorXd column = Eigen::VectorXd::Zero(layout.unknowns);
    layout.add_gradient(terms[t].gate, terms[t].by_number, column);
    priors.terms.col(t) = column;
  }
  return priors;
}

RowMatrix NormalMatrix::whole(double noise) const {
  constexpr std::size_t rows_at_once = 32;
  const std::size_t count = data.rows();
  RowMatrix sum(count, count);
  parallel_for(count, rows_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double* const row = &sum(i, 0);
      std::fill_n(row, i + 1, 0.0);
      for (const Eigen::MatrixXd* part : {&priors.cycle, &priors.terms}) {
        const Eigen::VectorXd factor = part->row(i);
        detail::add_lines(row, i + 1, part->data(), count, factor.data(), factor.size());
        if (part == &priors.cycle) row[i] += priors.diagonal[i];
      }
    }
    // Down the columns of the data, few rows at a time.
    for (std::size_t j = 0; j < end; ++j)
      for (std::size_t i = std::max(begin, j); i < end; ++i) sum(i, j) += data(i, j) / noise;
  });
  return sum;
}

void minimise(const BeatProblem& problem, Solution& solution, int most_steps, double tolerance,
              const Progress& progress) {
  constexpr int oldest = 5;
  constexpr double least_truth = 0.3;  // of the gain that the matrix predicts
  constexpr double calmest = 1e-4, wildest = 1e8;
  solution.objective = objective_value(problem, solution.unknowns);
  solution.converged = false;
  RowMatrix whole;
  const auto renew = [&] {
    const TraceStage noted("fit: normal matrix");
    // Both are large: the former goes before the next one comes.
    solution.matrix = {}, whole = {};
    solution.matrix = {data_matrix(problem, solution.unknowns, solution.objective, solution.every),
                       prior_matrix(problem, solution.unknowns, solution.objective)};
    whole = solution.matrix.whole(problem.noise);
  };
  if (solution.matrix.priors.diagonal.size() != solution.unknowns.size())
    renew();
  else
    whole = solution.matrix.whole(problem.noise);
  // Damping in units of what is believed: it holds back what the data hardly tell, and nothing else.
  const Eigen::VectorXd belief = problem.layout.spread.cwiseAbs2().cwiseInverse();
  for (int step = 0; step < most_steps; ++step) {
    progress.check();
    ++solution.steps;
    if (solution.objective.gradient.size() == 0)
      solution.objective.gradient = objective_gradient(problem, solution.unknowns, solution.objective);
    Eigen::VectorXd move = Cholesky(whole, solution.damping * belief).solve(solution.objective.gradient);
    // What the quadratic model of Levenberg and Marquardt promises of this step.
    const double predicted =
        0.5 * move.dot(solution.objective.gradient) + 0.5 * solution.damping * move.dot(belief.cwiseProduct(move));
    Objective next = objective_value(problem, solution.unknowns - move);
    double gain = solution.objective.value - next.value;
    // The valley of thick and pale against thin and bright walls bends: a part of the way may lead farther.
    for (int half = 0; half < 2 && !(gain > 0.3 * predicted); ++half) {
      Objective part = objective_value(problem, solution.unknowns - 0.4 * move);
      const double part_gain = solution.objective.value - part.value;
      if (gain >= part_gain) break;
      move *= 0.4, gain = part_gain, next = std::move(part);
    }
    if (!(gain > 0)) {
      if (solution.matrix.age > 0) renew();
      solution.damping *= 8;
      if (solution.damping > wildest) break;
      continue;
    }
    solution.unknowns -= move;
    solution.objective = std::move(next);
    const double truth = gain / predicted;
    if (truth > 0.7) solution.damping = std::max(solution.damping / 6, calmest);
    if (truth < 0.2) solution.damping *= 2;
    ++solution.matrix.age;
    if (gain < tolerance * solution.objective.value && predicted < 3 * tolerance * solution.objective.value) {
      solution.converged = true;
      break;
    }
    if (solution.matrix.age >= oldest || truth < least_truth) renew();
  }
}

}  // namespace dynasurf::psf_fit
