// A pyramid of springs falls on a floor (thesis fig. 4.10). Step doubling takes long steps in the air and short ones
// while it touches. Draws bouncing_pyramid.svg: the height of its tip over time, and the length of the steps.
#include <cmath>
#include <cstdio>

#include "dynasurf/dynamics/forces/forces.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"

#include "svg.hpp"

using namespace dynasurf;

int main() {
  std::vector<Vec3> corners{{-30, -30, 200}, {30, -30, 200}, {30, 30, 200}, {-30, 30, 200}, {0, 0, 250}};
  std::vector<dynamics::Spring> springs;
  for (std::uint32_t a = 0; a < 5; ++a)
    for (std::uint32_t b = a + 1; b < 5; ++b) springs.push_back({a, b, (corners[a] - corners[b]).norm()});
  dynamics::ParticleSystem pyramid = dynamics::particles_at(corners, 0.1);
  const dynamics::Force floor{"floor", [](const dynamics::ParticleState& s, std::span<Vec3> forces) {
                                for (std::size_t p = 0; p < forces.size(); ++p)
                                  if (s.positions[p][2] < 0) forces[p][2] -= 1e5 * s.positions[p][2];
                              }};
  pyramid.forces = {dynamics::spring_force(springs, {.stiffness = 2000, .damping = 0.5}),
                    dynamics::gravity_force(pyramid.masses), floor};

  // y: all places, then all speeds. Tolerances: 0.01 mm for a place, 1 mm/s for a speed.
  std::vector<double> y(30, 0.0), tolerance(30, 0.01), scratch(30 * dynamics::kSolverScratch);
  for (std::size_t i = 0; i < 15; ++i) y[i] = corners[i / 3][static_cast<Eigen::Index>(i % 3)];
  std::fill(tolerance.begin() + 15, tolerance.end(), 1.0);
  const dynamics::Derivative motion = dynamics::motion_of(pyramid);

  std::vector<Eigen::Vector2d> height, steps;
  double in_the_air = 0, touching = 1, step = 0.04;
  int count = 0, rejected = 0;
  for (double t = 0; t < 1; ++count) {
    const dynamics::AdaptiveStep done =
        dynamics::advance_once(dynamics::StepDoubling{}, y, std::min(step, 0.04), tolerance, motion, scratch);
    t += done.taken;
    step = done.next;
    rejected += done.rejected;
    const double lowest = std::min({y[2], y[5], y[8], y[11]});
    if (lowest > 1) in_the_air = std::max(in_the_air, done.taken);
    if (lowest < 0) touching = std::min(touching, done.taken);
    height.emplace_back(t, y[14]);
    steps.emplace_back(t, 5000 * done.taken);  // 5 pixels of height per ms
  }
  std::printf("%d steps and %d tried in vain; longest in the air %.2f ms, shortest on the floor %.3f ms\n", count,
              rejected, 1000 * in_the_air, 1000 * touching);
  Drawing drawing;
  drawing.line(height, "navy");
  drawing.line(steps, "crimson");
  drawing.save("bouncing_pyramid.svg", false);
  return touching < 0.1 * in_the_air && std::isfinite(y[14]) ? 0 : 1;
}
