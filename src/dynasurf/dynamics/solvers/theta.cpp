#include <vector>

#include "dynasurf/dynamics/solvers/solver.hpp"

namespace dynasurf::dynamics {

void solve_tridiagonal(std::span<const double> lower, std::span<const double> diagonal, std::span<const double> upper,
                       std::span<double> x) {
  const std::size_t n = x.size();
  if (n == 0) return;
  std::vector<double> ratio(n);
  double pivot = diagonal[0];
  x[0] /= pivot;
  for (std::size_t i = 1; i < n; ++i) {
    ratio[i] = upper[i - 1] / pivot;
    pivot = diagonal[i] - lower[i] * ratio[i];
    x[i] = (x[i] - lower[i] * x[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i > 0; --i) x[i - 1] -= ratio[i] * x[i];
}

void solve_cyclic(std::span<const double> lower, std::span<const double> diagonal, std::span<const double> upper,
                  std::span<double> x) {
  // The corners are a matrix of rank one, (g, 0 ... upper) (1, 0 ... lower/g)^T, less what it adds to the diagonal.
  const std::size_t n = x.size(), last = n - 1;
  const double g = -diagonal[0], top = lower[0], bottom = upper[last];
  std::vector<double> changed(diagonal.begin(), diagonal.end()), u(n, 0.0);
  changed[0] -= g;
  changed[last] -= top * bottom / g;
  u[0] = g;
  u[last] = bottom;
  solve_tridiagonal(lower, changed, upper, x);
  solve_tridiagonal(lower, changed, upper, u);
  const double share = (x[0] + top / g * x[last]) / (1 + u[0] + top / g * u[last]);
  for (std::size_t i = 0; i < n; ++i) x[i] -= share * u[i];
}

void advance_chain(const Chain& chain, std::span<double> y, double h, double theta, std::span<const double> pull) {
  const std::size_t n = y.size(), last = n - 1;
  const double k = chain.stiffness;
  std::vector<double> step(n), diagonal(n), beside(n, -theta * k);
  for (std::size_t i = 0; i < n; ++i) {
    const bool has_left = i > 0 || chain.closed, has_right = i < last || chain.closed;
    double force = pull.empty() ? 0 : pull[i];
    if (has_left) force += k * (y[i > 0 ? i - 1 : last] - y[i]);
    if (has_right) force += k * (y[i < last ? i + 1 : 0] - y[i]);
    step[i] = force;
    diagonal[i] = 1 / h + theta * k * ((has_left ? 1 : 0) + (has_right ? 1 : 0));
  }
  if (chain.closed)
    solve_cyclic(beside, diagonal, beside, step);
  else
    solve_tridiagonal(beside, diagonal, beside, step);
  for (std::size_t i = 0; i < n; ++i) y[i] += step[i];
}

}  // namespace dynasurf::dynamics
