#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "dynasurf/core/grid.hpp"

namespace dynasurf {

/// A triangle mesh: N vertices (mm) and M triangles of vertex indices, counter-clockwise seen from outside.
struct TriMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  bool operator==(const TriMesh&) const = default;
};

/// The mesh moved from the grid frame to the world. A left-handed grid would turn the surface inside out, so the
/// winding of its triangles is reversed then.
inline TriMesh to_world(const Grid& grid, TriMesh mesh) {
  for (Vec3& p : mesh.vertices) p = to_world(grid, p);
  if (grid.direction.determinant() < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

/// The inverse of `to_world`.
inline TriMesh to_grid(const Grid& grid, TriMesh mesh) {
  for (Vec3& p : mesh.vertices) p = to_grid(grid, p);
  if (grid.direction.determinant() < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

}  // namespace dynasurf
