// A field, a force and a stop of one's own: a sphere is drawn to a smaller one by a field written down as a formula,
// blown to one side by a wind, and held by a floor.
#include <cmath>
#include <cstdio>

#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/mesh/shapes.hpp"

using namespace dynasurf;

int main() {
  Grid grid;
  grid.dims = {60, 60, 60};

  // A field: one vector per voxel. Here, towards the sphere of 15 mm about the middle.
  const Vec3 middle(30, 30, 30);
  field::VectorField field(grid);
  for (int k = 0; k < 60; ++k)
    for (int j = 0; j < 60; ++j)
      for (int i = 0; i < 60; ++i) {
        const Vec3 out = Vec3(i, j, k) - middle;
        const Vec3 pull =
            out.norm() > 0 ? Vec3(0.1 * std::tanh((15 - out.norm()) / 4) * out.normalized()) : Vec3(0, 0, 0);
        const std::size_t voxel = grid.index(i, j, k);
        field.x[voxel] = static_cast<float>(pull[0]);
        field.y[voxel] = static_cast<float>(pull[1]);
        field.z[voxel] = static_cast<float>(pull[2]);
      }

  dynamics::Additions own;
  // A force: a name and a function that adds to the force on every particle.
  own.forces.push_back({"wind", [](const dynamics::ParticleState& s, std::span<Vec3> forces) {
                          for (std::size_t p = 0; p < forces.size(); ++p)
                            if (s.positions[p][0] > 30) forces[p] += Vec3(0.15, 0, 0);
                        }});
  // A stop: where a particle on its way from one point to another is held for good. Here, the plane z = 20.
  own.stop = [](const Vec3& from, const Vec3& to) -> std::optional<Vec3> {
    if (from[2] > 20 || to[2] <= 20) return std::nullopt;
    return Vec3(from + (20 - from[2]) / (to[2] - from[2]) * (to - from));
  };

  TriMesh start = mesh::icosphere(3);
  for (Vec3& p : start.vertices) p = middle + 24 * p;
  dynamics::Evolution options = dynamics::spring_model();
  options.model = dynamics::SpringModel{.stiffness = 0.1, .damping = 0.01, .rest_scale = 15.0 / 24};
  options.end.max_steps = 500;
  const dynamics::EvolutionResult result = dynamics::evolve(start, field, Image(grid), options, {}, own);

  Vec3 low = middle, high = middle;
  for (const Vec3& p : result.mesh.vertices) low = low.cwiseMin(p), high = high.cwiseMax(p);
  std::printf("%d steps of %.4f s; x from %.1f to %.1f, z from %.1f to %.1f\n", result.steps, result.step_s, low[0],
              high[0], low[2], high[2]);
  for (const Note& note : result.notes) std::printf("%s: %s\n", note.code.c_str(), note.message.c_str());
  io::write_mesh(result.mesh, "own_force.ply", io::MeshFormat::ply);
  // The wind carries the lee side farther out; the plane holds what comes from below.
  return high[0] - 30 > 30 - low[0] + 0.1 && result.stopped_fraction > 0.1 ? 0 : 1;
}
