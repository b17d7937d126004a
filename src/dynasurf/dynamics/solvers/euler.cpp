#include "dynasurf/dynamics/solvers/solver.hpp"

namespace dynasurf::dynamics {

// Thesis 4.6-4.10: y += h f(y).
void advance(const Euler&, std::span<double> y, double h, const Derivative& f, std::span<double> scratch) {
  const std::size_t n = y.size();
  const std::span<double> slope = scratch.first(n);
  f(y, slope);
  for (std::size_t i = 0; i < n; ++i) y[i] += h * slope[i];
}

}  // namespace dynasurf::dynamics
