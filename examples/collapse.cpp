// A sheet of particles that know nothing of each other, drawn to the origin by F = -x (thesis 5.1): without internal
// forces it collapses to a point. Draws collapse.svg: the path of every tenth particle, seen from above.
#include <cmath>
#include <cstdio>

#include "dynasurf/dynamics/forces/forces.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"

#include "svg.hpp"

using namespace dynasurf;

int main() {
  std::vector<Vec3> places;
  for (int j = -5; j <= 5; ++j)
    for (int i = -5; i <= 5; ++i) places.emplace_back(4 * i + 3, 4 * j, 30);
  const auto count = static_cast<double>(places.size());
  dynamics::ParticleSystem sheet = dynamics::particles_at(places, count);  // 1 kg each
  const dynamics::Force inwards{"inwards", [](const dynamics::ParticleState& s, std::span<Vec3> forces) {
                                  for (std::size_t p = 0; p < forces.size(); ++p) forces[p] -= s.positions[p];
                                }};
  sheet.forces = {inwards, dynamics::drag_force(0.5)};

  dynamics::ParticleSolver solver(dynamics::Rk4{});
  std::vector<std::vector<Eigen::Vector2d>> paths((places.size() + 9) / 10);
  for (int step = 0; step < 600; ++step) {
    solver.step(sheet, 0.05);
    for (std::size_t k = 0; k < paths.size(); ++k)
      paths[k].emplace_back(sheet.positions[10 * k][0], sheet.positions[10 * k][2]);
  }
  Drawing drawing;
  for (auto& path : paths) drawing.line(path, "navy");
  drawing.save("collapse.svg");

  double farthest = 0, expected = 0;
  // Every coordinate is the same damped oscillator: x(t) <= x0 exp(-t/4) w0 / w.
  for (std::size_t p = 0; p < places.size(); ++p) {
    farthest = std::max(farthest, sheet.positions[p].norm());
    expected = std::max(expected, places[p].norm() * std::exp(-0.25 * 30) / std::sqrt(1 - 1 / 16.0));
  }
  std::printf("after 30 s the farthest particle is %.4f mm from the origin; the envelope says %.4f mm\n", farthest,
              expected);
  return farthest <= expected ? 0 : 1;
}
