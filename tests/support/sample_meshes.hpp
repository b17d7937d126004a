#pragma once
#include <cmath>
#include <vector>

#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::test {

/// A closed surface that looks different in every mirror and from every side: a ball with three unequal half axes, a
/// bump towards +x, a twist, away from the origin. Vertices in mm.
inline TriMesh lopsided_ball(int level, double size_mm = 30) {
  TriMesh mesh = mesh::icosphere(level);
  for (Vec3& p : mesh.vertices) {
    const double bump = 1 + 0.3 * std::exp(4 * (p[0] - 1)) + 0.1 * p[1] * p[2] + 0.05 * p[2];
    p = Vec3(1.0, 0.7, 1.6).cwiseProduct(p) * bump * size_mm + Vec3(12.3, -45.6, 78.9);
  }
  return mesh;
}

/// A beat of `gates` meshes with the same triangles.
inline std::vector<TriMesh> beating_ball(int level, int gates) {
  std::vector<TriMesh> cycle;
  for (int g = 0; g < gates; ++g) cycle.push_back(lopsided_ball(level, 30 - 8 * std::sin(3.14159265 * g / gates)));
  return cycle;
}

}  // namespace dynasurf::test
