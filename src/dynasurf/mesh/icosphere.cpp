#include <cmath>
#include <cstdint>
#include <string>
#include <unordered_map>

#include "dynasurf/core/detail/edge_key.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::mesh {
namespace {

constexpr int kFinestLevel = 9;  // 2.6 million vertices

TriMesh icosahedron() {
  const double golden = (1 + std::sqrt(5.0)) / 2;
  TriMesh mesh;
  mesh.vertices = {{-1, golden, 0}, {1, golden, 0}, {-1, -golden, 0}, {1, -golden, 0},
                   {0, -1, golden}, {0, 1, golden}, {0, -1, -golden}, {0, 1, -golden},
                   {golden, 0, -1}, {golden, 0, 1}, {-golden, 0, -1}, {-golden, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (Vec3& p : mesh.vertices) p.normalize();
  return mesh;
}

/// Every triangle becomes four. The midpoints follow the old vertices, which keep their numbers.
TriMesh subdivide(const TriMesh& coarse) {
  TriMesh fine;
  fine.vertices = coarse.vertices;
  fine.vertices.reserve(coarse.vertices.size() * 4);
  fine.triangles.reserve(coarse.triangles.size() * 4);
  std::unordered_map<std::uint64_t, std::uint32_t> midpoint_of;
  midpoint_of.reserve(coarse.triangles.size() * 2);
  const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
    const auto [where, is_new] = midpoint_of.try_emplace(edge_key(a, b), fine.vertices.size());
    if (is_new) fine.vertices.push_back((coarse.vertices[a] + coarse.vertices[b]).normalized());
    return where->second;
  };
  for (const auto& [a, b, c] : coarse.triangles) {
    const std::uint32_t ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
    fine.triangles.push_back({a, ab, ca});
    fine.triangles.push_back({ab, b, bc});
    fine.triangles.push_back({ca, bc, c});
    fine.triangles.push_back({ab, bc, ca});
  }
  return fine;
}

}  // namespace

TriMesh icosphere(int level) {
  if (level < 0 || level > kFinestLevel)
    throw OptionError("icosphere level is " + std::to_string(level) + "; expected 0 to " +
                      std::to_string(kFinestLevel));
  TriMesh mesh = icosahedron();
  for (int l = 0; l < level; ++l) mesh = subdivide(mesh);
  return mesh;
}

}  // namespace dynasurf::mesh
