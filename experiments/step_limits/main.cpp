// Prints the tables of README.md: the largest stable step of each solver and mesh, and runs just below it.
#include <cmath>
#include <cstdio>
#include <ctime>
#include <random>

#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/dynamics/forces/forces.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"
#include "dynasurf/mesh/shapes.hpp"

#include "../support/hebron.hpp"
#include "../support/run_file.hpp"

using namespace dynasurf;
using namespace dynasurf::experiments;

namespace {

/// A mesh whose particles are given small speeds at random, held by drag and by dampers along the edges.
dynamics::ParticleSystem shaken(const MeshRun& run, double damping) {
  const TriMesh mesh = start_of(run, inner_border());
  dynamics::ParticleSystem system = dynamics::particles_at(mesh.vertices, run.evolution.mass_kg);
  std::mt19937 random(1);
  const auto number = [&] { return 1e-6 * (random() / 2147483648.0 - 1); };
  for (Vec3& v : system.velocities) v = Vec3(number(), number(), number());
  system.forces.push_back(dynamics::drag_force(run.evolution.force.drag));
  if (damping > 0)
    system.forces.push_back(dynamics::spring_force(dynamics::springs_of(mesh), {.stiffness = 0, .damping = damping}));
  return system;
}

/// Whether the motion dies out. Rates are bounded away from each other, so 300 steps tell growth from decay to 1e-4.
bool is_stable(const dynamics::ParticleSystem& start, const dynamics::SolverOptions& solver, double h) {
  dynamics::ParticleSystem system = start;
  dynamics::ParticleSolver stepper(solver);
  const double before = dynamics::kinetic_energy(system);
  for (int n = 0; n < 300; ++n) {
    stepper.step(system, h);
    const double now = dynamics::kinetic_energy(system);
    if (!(now < 1e6 * before)) return false;
  }
  return dynamics::kinetic_energy(system) <= before;
}

double limit(const dynamics::ParticleSystem& start, const dynamics::SolverOptions& solver, double above) {
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

void limits(const RunFile& file) {
  std::printf(
      "## Largest stable steps, s\n\n| solver | vertices | published | 2 or 2.785 m/k | found, drag alone | found, "
      "with the dampers | dampers: said beforehand |\n|---|---|---|---|---|---|---|\n");
  for (const Row<MeshRun>& row : rows_of<MeshRun>(file, "Table 4.2, steps")) {
    const dynamics::Evolution& how = row.options.evolution;
    const dynamics::ParticleSystem with = shaken(row.options, 1);
    const dynamics::Fastest modes = dynamics::fastest_modes(with);
    std::printf("| %s | %zu | %g | %.4f | %.4f | %.6f | %.6f |\n", row.name.c_str(), with.size(), how.step_s,
                dynamics::step_limit_s(how.solver, how.mass_kg, with.size(), how.force.drag),
                limit(shaken(row.options, 0), how.solver, 0.5), limit(with, how.solver, 0.05),
                dynamics::oscillator_limit_s(how.solver, 0, modes.damping));
  }
}

void runs(const RunFile& file) {
  std::printf(
      "\n## Runs with the steps of the table, cavity of the phantom\n\n| solver | vertices | dt, s | steps | CPU, ms | "
      "volume, mm3 | published CPU, s; volume |\n|---|---|---|---|---|---|---|\n");
  for (const Row<MeshRun>& row : rows_of<MeshRun>(file, "Table 4.2, runs")) {
    const TriMesh start = start_of(row.options, inner_border());
    const field::VectorField& field = field_of(inner_border());
    const double begin = cpu_ms();
    const dynamics::EvolutionResult r = dynamics::evolve(start, field, inner_border(), row.options.evolution);
    std::printf("| %s | %zu | %g | %d | %.1f | %.0f | %s |\n", row.name.c_str(), start.vertices.size(), r.step_s,
                r.steps, cpu_ms() - begin, mesh::volume_mm3(r.mesh), row.published.c_str());
  }
  std::printf("\nThe cavity of the data holds %.0f mm3.\n",
              1000 * synthetic::voxel_volume_ml(synthetic::enclosed_cavity(hebron())));
}

void print(const RunFile& file) {
  limits(file);
  runs(file);
}

}  // namespace

int main(int count, char** arguments) { return run_tables(count, arguments, print); }
