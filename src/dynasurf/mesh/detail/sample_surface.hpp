#pragma once
#include <cstdint>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::mesh {

/// A point of a surface: `weight[i]` of each corner of the triangle; the weights are positive and sum to 1.
/// A place on a surface: a triangle, and the weights of its corners, which sum to 1.
struct SurfaceSample {
  std::uint32_t triangle = 0;
  Vec3 weight;
};

/// `count` points spread evenly over the area: equal areas hold equally many points, up to one. Triangles are walked in
/// their order and the places within them follow a sequence of low discrepancy (R2), so nothing is drawn by chance and
/// the same mesh gives the same points. Empty when the mesh has no area. The vertices must be finite.
std::vector<SurfaceSample> sample_surface(const TriMesh& mesh, std::size_t count);

/// Where a sample lies.
inline Vec3 position_of(const TriMesh& mesh, const SurfaceSample& p) {
  const auto& [a, b, c] = mesh.triangles[p.triangle];
  return p.weight[0] * mesh.vertices[a] + p.weight[1] * mesh.vertices[b] + p.weight[2] * mesh.vertices[c];
}

}  // namespace dynasurf::mesh
