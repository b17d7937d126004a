#include "dynasurf/dynamics/solvers/solver.hpp"

namespace dynasurf::dynamics {

// Thesis 4.20-4.24, with slopes k/h: y += h (k1 + 2 k2 + 2 k3 + k4) / 6.
void advance(const Rk4&, std::span<double> y, double h, const Derivative& f, std::span<double> scratch) {
  const std::size_t n = y.size();
  const std::span<double> slope = scratch.first(n), sum = scratch.subspan(n, n), stage = scratch.subspan(2 * n, n);
  const auto add_slope_and_go = [&](double weight, double way) {
    for (std::size_t i = 0; i < n; ++i) {
      sum[i] += weight * slope[i];
      stage[i] = y[i] + way * slope[i];
    }
  };
  f(y, slope);
  for (std::size_t i = 0; i < n; ++i) sum[i] = 0;
  add_slope_and_go(1, h / 2);
  f(stage, slope);
  add_slope_and_go(2, h / 2);
  f(stage, slope);
  add_slope_and_go(2, h);
  f(stage, slope);
  for (std::size_t i = 0; i < n; ++i) y[i] += h / 6 * (sum[i] + slope[i]);
}

}  // namespace dynasurf::dynamics
