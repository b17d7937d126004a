// Prints the tables of README.md: the largest stable step of each solver and mesh, and runs just below it.
#include <cmath>
#include <cstdio>
#include <ctime>
#include <random>

#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/dynamics/forces/forces.hpp"
#include "dynasurf/dynamics/solvers/particle_solver.hpp"
#include "dynasurf/mesh/shapes.hpp"

#include "../support/hebron.hpp"

using namespace dynasurf;
using namespace dynasurf::experiments;

namespace {

constexpr double drag = 0.1;

struct Row {
  const char* name;
  SolverOptions solver;
  double published_s[3];
};
const Row rows[] = {{"Euler", Euler{}, {0.1, 0.031, 0.007}},
                    {"midpoint", Midpoint{}, {0.12, 0.031, 0.007}},
                    {"RK4", Rk4{}, {0.172, 0.043, 0.01}}};

/// A mesh of 1 kg whose particles are given small speeds at random, held by drag and by dampers along the edges.
ParticleSystem shaken(int level, double damping) {
  const TriMesh mesh = place(icosphere(level), inner_border(), {});
  ParticleSystem system = particles_at(mesh.vertices, 1);
  std::mt19937 random(1);
  const auto number = [&] { return 1e-6 * (random() / 2147483648.0 - 1); };
  for (Vec3& v : system.velocities) v = Vec3(number(), number(), number());
  system.forces.push_back(drag_force(drag));
  if (damping > 0) system.forces.push_back(spring_force(springs_of(mesh), {.stiffness = 0, .damping = damping}));
  return system;
}

/// Whether the motion dies out. Rates are bounded away from each other, so 300 steps tell growth from decay to 1e-4.
bool is_stable(const ParticleSystem& start, const SolverOptions& solver, double h) {
  ParticleSystem system = start;
  ParticleSolver stepper(solver);
  const double before = kinetic_energy(system);
  for (int n = 0; n < 300; ++n) {
    stepper.step(system, h);
    const double now = kinetic_energy(system);
    if (!(now < 1e6 * before)) return false;
  }
  return kinetic_energy(system) <= before;
}

double limit(const ParticleSystem& start, const SolverOptions& solver, double above) {
  double good = 0, bad = above;
  for (int n = 0; n < 16; ++n) {
    const double h = (good + bad) / 2;
    (is_stable(start, solver, h) ? good : bad) = h;
  }
  return good;
}

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

void limits() {
  std::printf(
      "## Largest stable steps, s\n\n| solver | vertices | published | 2 or 2.785 m/k | found, drag alone | found, "
      "with the dampers | dampers: said beforehand |\n|---|---|---|---|---|---|---|\n");
  for (const Row& row : rows)
    for (const int level : {2, 3, 4}) {
      const auto m = static_cast<std::size_t>(level - 2);
      const ParticleSystem with = shaken(level, 1);
      const Fastest modes = fastest_modes(with);
      std::printf("| %s | %zu | %g | %.4f | %.4f | %.6f | %.6f |\n", row.name, with.size(), row.published_s[m],
                  step_limit_s(row.solver, 1, with.size(), drag), limit(shaken(level, 0), row.solver, 0.5),
                  limit(with, row.solver, 0.05), oscillator_limit_s(row.solver, 0, modes.damping));
    }
}

void runs() {
  std::printf(
      "\n## Runs with the steps of the table, cavity of the phantom\n\n| solver | vertices | dt, s | steps | CPU, ms | "
      "volume, mm3 | published CPU, s | published volume |\n|---|---|---|---|---|---|---|---|\n");
  const char* published[3][3][2] = {{{"0.07", "60338.9"}, {"1.732", "66979"}, {"22.697", "69114.9"}},
                                    {{"0.02", "62054.5"}, {"1.265", "68304.6"}, {"46.191", "67917.3"}},
                                    {{"0.06", "62308.2"}, {"1.273", "67850"}, {"18.342", "69007.5"}}};
  for (std::size_t s = 0; s < 3; ++s)
    for (const int level : {2, 3, 4}) {
      const auto m = static_cast<std::size_t>(level - 2);
      Evolution how;
      how.solver = rows[s].solver;
      how.step_s = rows[s].published_s[m];
      how.force = {.strength = 10, .drag = drag};
      how.smooth_every = 0;
      how.smooth_after.sweeps = 0;
      how.end.max_steps = 20000;
      const TriMesh start = place(icosphere(level), inner_border(), {});
      const VectorField& field = field_of(inner_border());
      const double begin = cpu_ms();
      const EvolutionResult r = evolve(start, field, inner_border(), how);
      std::printf("| %s | %zu | %g | %d | %.1f | %.0f | %s | %s |\n", rows[s].name, start.vertices.size(), r.step_s,
                  r.steps, cpu_ms() - begin, volume_mm3(r.mesh), published[s][m][0], published[s][m][1]);
    }
  std::printf("\nThe cavity of the data holds %.0f mm3.\n", 1000 * voxel_volume_ml(enclosed_cavity(hebron())));
}

}  // namespace

int main() {
  std::printf("# Results\n\n");
  limits();
  runs();
}
