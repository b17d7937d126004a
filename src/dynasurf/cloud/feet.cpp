#include "dynasurf/cloud/detail/feet.hpp"

#include <cmath>

#include "dynasurf/core/parallel.hpp"

namespace dynasurf::cloud {

Vec3 normal_of(const TriMesh& mesh, std::uint32_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).normalized();
}

std::vector<Foot> feet_of(std::span<const Vec3> points, std::size_t step, const TriMesh& mesh,
                          const mesh::ClosestPoint& closest) {
  constexpr std::size_t grain = 256;
  std::vector<Foot> feet(points.size() / step);
  parallel_for(feet.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& p = points[i * step];
      const mesh::SurfacePoint found = closest(p);
      const auto& [a, b, c] = mesh.triangles[found.triangle];
      Foot& foot = feet[i];
      foot.place = found.weights[0] * mesh.vertices[a] + found.weights[1] * mesh.vertices[b] +
                   found.weights[2] * mesh.vertices[c];
      foot.normal = normal_of(mesh, found.triangle);
      const double distance = std::sqrt(found.distance2);
      foot.distance = (p - foot.place).dot(foot.normal) < 0 ? -distance : distance;
    }
  });
  return feet;
}

}  // namespace dynasurf::cloud
