#include "dynasurf/psf_fit/detail/pixel_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::psf_fit {
namespace {

/// What a fit leaves, freed of what stands still or moves with the beat: third differences over the gates, which keep
/// the variance of noise that differs from gate to gate. What is left itself where there are too few gates.
std::vector<std::vector<float>> fast_part(const std::vector<std::vector<float>>& residual) {
  const std::size_t gates = residual.size();
  if (gates < 6) return residual;
  const float scale = 1 / std::sqrt(20.0F);
  std::vector<std::vector<float>> fast = residual;
  for (std::size_t g = 0; g < gates; ++g)
    for (std::size_t n = 0; n < fast[g].size(); ++n)
      fast[g][n] = scale * (residual[(g + gates - 1) % gates][n] - 3 * residual[g][n] +
                            3 * residual[(g + 1) % gates][n] - residual[(g + 2) % gates][n]);
  return fast;
}

/// What stands still in the residuals beyond what noise leaves in the mean of the gates: reconstructions that the model
/// does not describe. Of sharp images that is texture, which moves no wall.
double standing_misfit(const BeatProblem& problem, const Objective& objective, double noise_variance) {
  if (problem.sigma_mm <= 0) return 0;
  const double gates = objective.residual.size();
  double squares = 0, weights = 0;
  for (std::size_t n = 0; n < problem.weight.size(); ++n) {
    double mean = 0;
    for (const auto& residual : objective.residual) mean += residual[n] / gates;
    squares += problem.weight[n] * mean * mean;
    weights += problem.weight[n];
  }
  return weights > 0 ? std::max(0.0, squares / weights - noise_variance / gates) : 0;
}

}  // namespace

PixelNoise noise_of(const BeatProblem& problem, const Objective& objective) {
  const std::vector<std::vector<float>> noise = fast_part(objective.residual);
  const Index3 dims = problem.pixels.count;
  const std::size_t stride[3] = {1, size_of({dims[0], 1, 1}), size_of({dims[0], dims[1], 1})};
  std::vector<std::vector<float>> scaled = noise;
  std::vector<double> squares;
  for (auto& values : scaled)
    for (std::size_t n = 0; n < values.size(); ++n) {
      values[n] *= std::sqrt(problem.weight[n]);
      if (problem.weight[n] > 0) squares.push_back(values[n] * values[n]);
    }
  // By the median, so that a hot neighbour does not pass for noise.
  const double variance = std::max(1e-12, quantile(squares, 0.5) / (0.6745 * 0.6745));
  const float most = 3 * std::sqrt(variance);
  for (auto& values : scaled)
    for (float& v : values) v = std::clamp(v, -most, most);
  std::array<double, 3> along;  // how many pixels of a row share their noise
  parallel_for(along.size(), 1, [&](std::size_t axis, std::size_t) {
    along[axis] = 1;
    for (int lag = 1; lag < 8 && lag < dims[axis]; ++lag) {
      double product = 0, pairs = 0;
      const std::size_t apart = stride[axis] * lag;
      const std::size_t length = dims[axis];
      for (const auto& values : scaled)
        for (std::size_t n = 0; n + apart < values.size(); ++n) {
          if (problem.weight[n] <= 0 || problem.weight[n + apart] <= 0) continue;
          if (n / stride[axis] % length + lag >= length) continue;
          product += values[n] * values[n + apart];
          pairs += 1;
        }
      const double correlation = pairs > 0 ? product / pairs / variance : 0;
      if (correlation < 0.05) break;
      along[axis] += 2 * correlation;
    }
  });
  double shared = 1, shared_within_blur = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double of_axis = along[axis];
    const double pixel_mm = problem.pixels.spacing[axis] * problem.pixels.joined[axis];
    const double within_blur = 2 * std::sqrt(M_PI) * problem.sigma_mm / pixel_mm;
    shared *= of_axis;
    shared_within_blur *= problem.sigma_mm > 0 ? std::min(of_axis, std::max(1.0, within_blur)) : of_axis;
  }
  constexpr double least = 1e-5;  // of the square of healthy muscle: no model is better than that
  const double alone = std::max(variance, least);
  // What the model leaves out stands still: no number of gates averages it away.
  const double gates = objective.residual.size();
  // The fit has bent towards a part of the misfit, which is not seen: 1.5 was chosen on seeds 1 to 30 of
  // experiments/camera.
  constexpr double unseen_too = 1.5;
  const double seen = standing_misfit(problem, objective, variance);
  const double misfit = gates * (usual_misfit + unseen_too * seen);
  return {alone * shared + misfit * shared_within_blur, (alone + gates * usual_misfit) * shared, seen};
}

}  // namespace dynasurf::psf_fit
