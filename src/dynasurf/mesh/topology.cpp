#include <algorithm>
#include <numeric>
#include <tuple>

#include "dynasurf/mesh/measures.hpp"

namespace dynasurf::mesh {
namespace {

/// One side of a triangle, named by its ends in ascending order.
struct Side {
  std::uint32_t low, high;
  bool ascending;  // the triangle runs from `low` to `high`
  bool same_edge(const Side& o) const { return low == o.low && high == o.high; }
};

std::vector<Side> sorted_sides(const TriMesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(mesh.triangles.size() * 3);
  for (const auto& t : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t from = t[c], to = t[(c + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), from < to});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.ascending) < std::tie(b.low, b.high, b.ascending);
  });
  return sides;
}

int count_components(std::size_t vertices, const std::vector<Side>& sides) {
  std::vector<std::uint32_t> parent(vertices);
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  int components = vertices;
  for (const Side& s : sides) {
    const std::uint32_t a = root(s.low), b = root(s.high);
    if (a == b) continue;
    parent[a] = b;
    --components;
  }
  return components;
}

}  // namespace

Topology topology(const TriMesh& mesh) {
  Topology result;
  result.vertices = mesh.vertices.size();
  result.triangles = mesh.triangles.size();
  const std::vector<Side> sides = sorted_sides(mesh);
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    std::size_t ascending = 0;
    for (; end < sides.size() && sides[end].same_edge(sides[begin]); ++end) ascending += sides[end].ascending ? 1 : 0;
    const std::size_t triangles = end - begin;
    ++result.edges;
    if (triangles == 1) ++result.boundary_edges;
    if (triangles > 2) ++result.non_manifold_edges;
    if (triangles == 2 && ascending != 1) ++result.misoriented_edges;
  }
  result.components = count_components(result.vertices, sides);
  const Index vertices = result.vertices, edges = result.edges, triangles = result.triangles;
  result.euler = vertices - edges + triangles;
  return result;
}

}  // namespace dynasurf::mesh
