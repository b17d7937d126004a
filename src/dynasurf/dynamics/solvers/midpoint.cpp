#include "dynasurf/dynamics/solvers/solver.hpp"

namespace dynasurf::dynamics {

// Thesis 4.11-4.19: y += h f(y + h/2 f(y)).
void advance(const Midpoint&, std::span<double> y, double h, const Derivative& f, std::span<double> scratch) {
  const std::size_t n = y.size();
  const std::span<double> slope = scratch.first(n), middle = scratch.subspan(n, n);
  f(y, slope);
  for (std::size_t i = 0; i < n; ++i) middle[i] = y[i] + h / 2 * slope[i];
  f(middle, slope);
  for (std::size_t i = 0; i < n; ++i) y[i] += h * slope[i];
}

}  // namespace dynasurf::dynamics
