// Three solvers on a circular orbit (thesis fig. 4.4): Euler spirals outwards, the others keep the circle.
// Draws euler_spiral.svg.
#include <cmath>
#include <cstdio>

#include "dynasurf/dynamics/solvers/solver.hpp"

#include "svg.hpp"

using namespace dynasurf;

int main() {
  const double turn_rate = 1, step = 0.1;
  const int steps = 188;  // three turns
  const dynamics::Derivative orbit = [&](std::span<const double> y, std::span<double> dydt) {
    dydt[0] = -turn_rate * y[1];
    dydt[1] = turn_rate * y[0];
  };
  const struct {
    const char *name, *colour;
    dynamics::SolverOptions solver;
    double growth;  // of the radius per step: the length of the method's polynomial at i h w
  } methods[] = {{"Euler", "crimson", dynamics::Euler{}, std::hypot(1, step)},
                 {"midpoint", "darkorange", dynamics::Midpoint{}, std::hypot(1 - step * step / 2, step)},
                 {"RK4", "seagreen", dynamics::Rk4{},
                  std::hypot(1 - step * step / 2 + std::pow(step, 4) / 24, step - std::pow(step, 3) / 6)}};

  Drawing drawing;
  bool as_expected = true;
  for (const auto& method : methods) {
    std::vector<double> y{1, 0}, scratch(2 * dynamics::kSolverScratch);
    std::vector<Eigen::Vector2d> path{{1, 0}};
    for (int s = 0; s < steps; ++s) {
      dynamics::advance(method.solver, y, step, orbit, scratch);
      path.emplace_back(y[0], y[1]);
    }
    const double radius = std::hypot(y[0], y[1]), expected = std::pow(method.growth, steps);
    std::printf("%-9s radius after three turns: %.6f, expected %.6f\n", method.name, radius, expected);
    as_expected = as_expected && std::abs(radius - expected) < 1e-9;
    drawing.line(path, method.colour);
  }
  drawing.save("euler_spiral.svg");
  return as_expected ? 0 : 1;
}
