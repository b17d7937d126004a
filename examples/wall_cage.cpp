// The wall of a ventricle at two resolutions (thesis 6.1.6.2): a coarse cage of tetrahedra is pressed, and a fine wall
// follows it; and the coarse wall made finer where it is pressed. Both are held against the fine wall pressed itself.
// usage: example_wall_cage
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <optional>

#include "dynasurf/mesh/tetrahedra.hpp"
#include "dynasurf/synthetic/ventricle_shape.hpp"
#include "dynasurf/ventricle/measures/wall_solid.hpp"

namespace {

using namespace dynasurf;

struct Wall {
  mesh::TetMesh mesh;
  std::vector<mesh::HeldVertex> held;
  std::uint32_t pressed = 0;  // in the middle of the lateral wall, outside
};

std::optional<Wall> wall_of(const ventricle::WallSolidSize& size) {
  const synthetic::VentricleShape shape = synthetic::shape_at({110, 44, 120, 1.65, 12}, 110);
  const TriMesh endo = synthetic::endo_surface(shape), epi = synthetic::epi_surface(shape);
  const auto axes = ventricle::axes_of(endo, epi, {0, 0, shape.centre_z}, {0, 0, 1}, {0, -1, 0}, std::nullopt);
  const auto solid = axes ? ventricle::wall_solid(endo, epi, *axes, size) : std::nullopt;
  if (!solid || solid->quality.not_positive > 0) return std::nullopt;
  Wall wall{solid->mesh, {}, 0};
  const Vec3 place(shape.epi_radius, 0, shape.centre_z);
  double least = 1e300;
  for (std::uint32_t v = 0; v < wall.mesh.vertices.size(); ++v) {
    if (solid->ring[v] == size.rings) wall.held.push_back({v, Vec3::Zero()});
    const double away = (wall.mesh.vertices[v] - place).norm();
    if (solid->layer[v] == size.layers && away < least) least = away, wall.pressed = v;
  }
  return wall;
}

std::vector<Vec3> press(const Wall& wall) {
  const std::vector<mesh::VertexForce> force{{wall.pressed, {-0.05, 0, 0}}};
  return mesh::solve_elastic(wall.mesh, {}, wall.held, force);
}

double length_of(const std::vector<Vec3>& moved) {
  double sum = 0;
  for (const Vec3& m : moved) sum += m.squaredNorm();
  return std::sqrt(sum);
}

double apart(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  std::vector<Vec3> difference(a.size());
  for (std::size_t n = 0; n < a.size(); ++n) difference[n] = a[n] - b[n];
  return length_of(difference) / length_of(b);
}

int show() {
  const std::optional<Wall> coarse = wall_of({8, 24, 1}), fine = wall_of({16, 48, 2});
  if (!coarse || !fine) return 1;
  const std::vector<Vec3> cage = press(*coarse), reference = press(*fine);
  const std::vector<Vec3> driven = mesh::carried(coarse->mesh, cage, fine->mesh.vertices);
  std::printf("cage of %zu tetrahedra, wall of %zu: driven by the cage the wall is %.0f %% from its own answer\n",
              coarse->mesh.tetrahedra.size(), fine->mesh.tetrahedra.size(), 100 * apart(driven, reference));

  Wall local = *coarse;
  double depth[4] = {cage[coarse->pressed].norm()};
  for (int round = 1; round < 4; ++round) {
    std::vector<std::uint32_t> near;
    for (std::uint32_t n = 0; n < local.mesh.tetrahedra.size(); ++n)
      for (const std::uint32_t v : local.mesh.tetrahedra[n])
        if ((local.mesh.vertices[v] - local.mesh.vertices[local.pressed]).norm() < 12.0 / round) {
          near.push_back(n);
          break;
        }
    local.mesh = mesh::refined(local.mesh, near);
    depth[round] = press(local)[local.pressed].norm();
    std::printf("refined %d times where it is pressed: %zu tetrahedra, pressed by %.3f mm (before: %.3f, fine: %.3f)\n",
                round, local.mesh.tetrahedra.size(), depth[round], depth[round - 1], reference[fine->pressed].norm());
  }
  const bool gives_way_more = depth[1] > depth[0] && depth[2] > depth[1] && depth[3] > depth[2];
  return apart(driven, reference) < 0.5 && gives_way_more ? 0 : 1;
}

}  // namespace

int main() {
  try {
    return show();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
