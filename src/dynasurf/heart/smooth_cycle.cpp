#include "dynasurf/heart/detail/smooth_cycle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::heart {
namespace {

Eigen::MatrixXd waves_over(Eigen::Index gates, Eigen::Index most) {
  const Eigen::Index waves = std::min<Eigen::Index>(most, gates >= 12 ? 3 : gates >= 6 ? 2 : gates >= 4 ? 1 : 0);
  Eigen::MatrixXd basis(gates, 1 + 2 * waves);
  for (Eigen::Index g = 0; g < gates; ++g) {
    basis(g, 0) = 1;
    for (Eigen::Index w = 1; w <= waves; ++w) {
      const double angle = 2 * std::numbers::pi * (w * g) / gates;
      basis(g, 2 * w - 1) = own::cos(angle), basis(g, 2 * w) = own::sin(angle);
    }
  }
  return basis;
}

}  // namespace

SmoothCycle smooth_over_cycle(std::span<const std::optional<double>> values, double cut, int most_waves) {
  const Eigen::Index n = values.size();
  const Eigen::MatrixXd basis = waves_over(n, most_waves);
  const Eigen::Index terms = basis.cols();
  Eigen::VectorXd fit = Eigen::VectorXd::Zero(n);
  for (int round = 0; round < 8; ++round) {
    Eigen::MatrixXd normal = 1e-6 * Eigen::MatrixXd::Identity(terms, terms);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(terms);
    for (Eigen::Index g = 0; g < n; ++g) {
      const auto& value = values[g];
      if (!value) continue;
      const double x = round == 0 ? 0 : (*value - fit[g]) / (round < 3 ? 2 * cut : cut);
      if (std::abs(x) >= 1) continue;
      const double weight = (1 - x * x) * (1 - x * x);
      normal += weight * basis.row(g).transpose() * basis.row(g);
      right += weight * *value * basis.row(g).transpose();
    }
    fit = basis * normal.ldlt().solve(right);
  }
  SmoothCycle cycle;
  for (Eigen::Index g = 0; g < n; ++g) {
    const auto& value = values[g];
    cycle.outlier.push_back(!value || std::abs(*value - fit[g]) > cut);
    cycle.values.push_back(fit[g]);
  }
  return cycle;
}

}  // namespace dynasurf::heart
