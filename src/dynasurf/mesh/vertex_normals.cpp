#include "dynasurf/mesh/detail/vertex_normals.hpp"

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::mesh {

std::vector<Vec3> vertex_normals(const TriMesh& mesh, const std::vector<bool>& counts) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!counts.empty() && !counts[t]) continue;
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3 n = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    for (const auto v : {a, b, c}) normals[v] += n;
  }
  constexpr double least = 1e-100;  // the squares of what is shorter may vanish
  for (Vec3& n : normals) {
    const double length = n.norm();
    n = length > least ? Vec3(n / length) : Vec3(n.stableNormalized());
  }
  return normals;
}

std::vector<Vec3> angle_weighted_normals(const TriMesh& mesh) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
  for (const auto& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      const Vec3& at = mesh.vertices[t[c]];
      const Vec3 a = mesh.vertices[t[(c + 1) % 3]] - at, b = mesh.vertices[t[(c + 2) % 3]] - at;
      const Vec3 n = a.cross(b);
      const double length = n.norm();
      if (length > 0) normals[t[c]] += n / length * own::atan2(length, a.dot(b));
    }
  for (Vec3& n : normals)
    if (n.norm() > 0) n.normalize();
  return normals;
}

}  // namespace dynasurf::mesh
