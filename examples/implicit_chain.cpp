// A closed chain of springs contracts (thesis 4.3, eqs 4.29-4.36): with a step ten times the longest that explicit
// Euler takes, theta 0 flies apart; 1/2 and 1 go to rest.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "dynasurf/dynamics/solvers/solver.hpp"

using namespace dynasurf;

namespace {

/// The farthest point from the middle after `steps`.
double extent_after(double theta, double h, int steps) {
  constexpr int points = 40;
  std::vector<double> x(points), y(points);
  for (std::size_t n = 0; n < points; ++n) {
    const double angle = 2 * 3.14159265358979 * static_cast<double>(n) / points;
    x[n] = std::cos(angle) + (n % 2 == 0 ? 0.05 : -0.05);
    y[n] = std::sin(angle);
  }
  for (int step = 0; step < steps; ++step) {
    dynamics::advance_chain({.stiffness = 1, .closed = true}, x, h, theta);
    dynamics::advance_chain({.stiffness = 1, .closed = true}, y, h, theta);
  }
  double farthest = 0;
  for (std::size_t n = 0; n < points; ++n) farthest = std::max(farthest, std::hypot(x[n], y[n]));
  return farthest;
}

}  // namespace

int main() {
  constexpr double h = 5;  // 2 / the largest eigenvalue, 4, is the explicit limit
  const double explicit_end = extent_after(0, h, 60), middle = extent_after(0.5, h, 60),
               implicit = extent_after(1, h, 60);
  std::printf("after 60 steps of %g s a circle of radius 1 has the radius %.3g (theta 0), %.3g (1/2), %.3g (1)\n", h,
              explicit_end, middle, implicit);
  return explicit_end > 1e6 && middle < 0.2 && implicit < 0.2 ? 0 : 1;
}
