// The wall of a ventricle as an elastic solid (thesis 6.1.6.2): filled with tetrahedra, held at the base, pressed at
// one point of its side. What comes out is symmetric as the wall is, and smaller the farther from the point. Writes
// wall.vtu with the displacement of every vertex. usage: example_wall_elastic
#include <cmath>
#include <cstdio>
#include <exception>

#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/mesh/tetrahedra.hpp"
#include "dynasurf/synthetic/ventricle_shape.hpp"
#include "dynasurf/ventricle/measures/wall_solid.hpp"

namespace {

using namespace dynasurf;

/// The outer vertex nearest to a place.
std::uint32_t nearest_outside(const ventricle::WallSolid& wall, int layers, const Vec3& place) {
  std::uint32_t best = 0;
  double least = 1e300;
  for (std::uint32_t v = 0; v < wall.mesh.vertices.size(); ++v)
    if (const double d = (wall.mesh.vertices[v] - place).norm(); wall.layer[v] == layers && d < least)
      best = v, least = d;
  return best;
}

bool press(double volume_ml) {
  const synthetic::VentricleShape shape = synthetic::shape_at({110, 44, 120, 1.65, 12}, volume_ml);
  const TriMesh endo = synthetic::endo_surface(shape), epi = synthetic::epi_surface(shape);
  const auto axes = ventricle::axes_of(endo, epi, {0, 0, shape.centre_z}, {0, 0, 1}, {0, -1, 0}, std::nullopt);
  const ventricle::WallSolidSize size{16, 48, 2};
  const auto wall = axes ? ventricle::wall_solid(endo, epi, *axes, size) : std::nullopt;
  if (!wall || wall->quality.not_positive > 0) return false;

  std::vector<mesh::HeldVertex> held;
  for (std::uint32_t v = 0; v < wall->mesh.vertices.size(); ++v)
    if (wall->ring[v] == size.rings) held.push_back({v, Vec3::Zero()});
  // In the middle of the lateral wall, on a sector's border, so that the wall is symmetric about it.
  const std::uint32_t point = nearest_outside(*wall, size.layers, {shape.epi_radius, 0, shape.centre_z});
  const std::vector<mesh::VertexForce> forces{{point, {-0.05, 0, 0}}};
  const std::vector<Vec3> moved = mesh::solve_elastic(wall->mesh, {}, held, forces);

  double most = 0, far_away = 0, lean = 0;
  std::vector<float> lengths;
  for (std::uint32_t v = 0; v < moved.size(); ++v) {
    lengths.push_back(static_cast<float>(moved[v].norm()));
    most = std::max(most, moved[v].norm());
    if (wall->mesh.vertices[v][0] < -0.9 * shape.endo_radius) far_away = std::max(far_away, moved[v].norm());
    lean += moved[v][1];
  }
  lean = std::abs(lean) / static_cast<double>(moved.size());
  std::printf(
      "cavity %3.0f mL: %zu tetrahedra, %.2f of %.2f mL; pressed by %.2f mm, the far side by %.2f mm, sideways %.3f "
      "mm\n",
      volume_ml, wall->quality.count, wall->volume_ml, wall->surfaces_ml, most, far_away, lean);
  io::write_solid(wall->mesh, "wall.vtu", io::SolidFormat::vtu,
                  std::vector<io::VertexScalar>{{"displacement_mm", lengths}});
  // The cut into tetrahedra is not symmetric, so its answer is so only nearly.
  return most == moved[point].norm() && moved[point][0] < 0 && far_away < 0.5 * most && lean < 0.03 * most;
}

}  // namespace

int main() {
  try {
    // A thin wall at end diastole gives way more than a thick one at end systole.
    return press(110) && press(44) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
