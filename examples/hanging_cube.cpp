// A cube of springs, hung from eight fixed points, sags under its weight (thesis fig. 3.4): stiffer springs, less sag.
// Writes cube_<stiffness>.ply, and draws all beside the cube that has no weight to cube.svg.
#include <cmath>
#include <cstdio>

#include "dynasurf/dynamics/forces/forces.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"
#include "dynasurf/io/mesh_io.hpp"

#include "svg.hpp"

using namespace dynasurf;

namespace {

TriMesh cube(double side_mm) {
  TriMesh m;
  for (int v = 0; v < 8; ++v) m.vertices.emplace_back(side_mm * (v & 1), side_mm * (v >> 1 & 1), side_mm * (v >> 2));
  m.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return m;
}

}  // namespace

int main() {
  const double mass_kg = 0.01, weight = mass_kg * 9810;  // of one corner, kg mm/s2
  bool as_expected = true;
  Vec3 aside(0, 0, 0);
  Drawing drawing;
  drawing.mesh(cube(50).vertices, cube(50).triangles, "grey");
  for (const double stiffness : {10.0, 20.0, 40.0}) {
    TriMesh m = cube(50);
    std::vector<Vec3> places = m.vertices;
    std::vector<dynamics::Spring> springs = dynamics::springs_of(m);
    for (std::uint32_t corner = 0; corner < 8; ++corner) {  // each corner hangs from a point 30 mm above it
      places.push_back(m.vertices[corner] + Vec3(0, 0, 30));
      springs.push_back({corner, corner + 8, 30});
    }
    dynamics::ParticleSystem system = dynamics::particles_at(places, 16 * mass_kg);
    system.pinned = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1};
    system.forces = {dynamics::spring_force(springs, {.stiffness = stiffness, .damping = 0.1}),
                     dynamics::gravity_force(system.masses)};

    dynamics::ParticleSolver solver(dynamics::Rk4{});
    double lowest = 0;
    for (int step = 0; step < 20000; ++step) {
      solver.step(system, 5e-4);
      lowest = std::min(lowest, system.positions[0][2]);
    }
    const double sag = -system.positions[0][2];
    std::printf("stiffness %2.0f: lowest %.2f mm, comes to rest at %.3f mm, m g / k = %.3f mm\n", stiffness, -lowest,
                sag, weight / stiffness);
    as_expected = as_expected && std::abs(sag - weight / stiffness) < 0.01;
    m.vertices.assign(system.positions.begin(), system.positions.begin() + 8);
    io::write_mesh(m, "cube_" + std::to_string(static_cast<int>(stiffness)) + ".ply", io::MeshFormat::ply);
    aside += Vec3(75, 50, 0);
    drawing.mesh(m.vertices, m.triangles, "teal", aside);
  }
  drawing.save("cube.svg");
  return as_expected ? 0 : 1;
}
