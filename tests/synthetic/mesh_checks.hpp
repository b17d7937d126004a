#pragma once
#include <array>
#include <map>
#include <utility>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::synthetic {

/// Volume by tetrahedra to the origin: the tests' own, so that the generator is not judged by the program's measures.
inline double signed_volume_ml(const TriMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]])) / 6;
  return sum / 1000;
}

/// Centre of mass of the solid inside a closed mesh.
inline Vec3 centroid_of(const TriMesh& mesh) {
  Vec3 sum{0, 0, 0};
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double v = a.dot(b.cross(c)) / 6;
    sum += v * (a + b + c) / 4;
    volume += v;
  }
  return sum / volume;
}

/// True when each directed edge occurs once and its reverse once: closed, manifold along edges, consistently oriented.
inline bool closed_and_oriented(const TriMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles)
    for (int e = 0; e < 3; ++e) ++edges[{t[e], t[(e + 1) % 3]}];
  for (const auto& [edge, n] : edges) {
    const auto reverse = edges.find({edge.second, edge.first});
    if (n != 1 || reverse == edges.end() || reverse->second != 1) return false;
  }
  return !edges.empty();
}

}  // namespace dynasurf::synthetic
