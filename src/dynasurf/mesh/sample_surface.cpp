#include "dynasurf/mesh/detail/sample_surface.hpp"

#include <algorithm>
#include <cmath>

namespace dynasurf::mesh {
namespace {

double area_of(const TriMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  return (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]).norm() / 2;
}

/// The n-th point of the R2 sequence (additive recurrence with the powers of the plastic number), folded from the unit
/// square into the triangle.
Vec3 weights_of(std::size_t n) {
  double u = std::fmod(0.5 + n * 0.7548776662466927, 1.0);
  double v = std::fmod(0.5 + n * 0.5698402909980532, 1.0);
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  return {1 - u - v, u, v};
}

}  // namespace

std::vector<SurfaceSample> sample_surface(const TriMesh& mesh, std::size_t count) {
  double whole = 0;
  for (const auto& t : mesh.triangles) whole += area_of(mesh, t);
  std::vector<SurfaceSample> points;
  if (!(whole > 0)) return points;
  points.reserve(count);
  // Point n lies where (n + 1/2) of `count` equal parts of the area are passed.
  double passed = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    passed += area_of(mesh, mesh.triangles[t]);
    while (points.size() < count && (points.size() + 0.5) * whole < passed * count)
      points.push_back({static_cast<std::uint32_t>(t), weights_of(points.size())});
  }
  return points;
}

}  // namespace dynasurf::mesh
