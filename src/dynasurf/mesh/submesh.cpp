#include "dynasurf/mesh/detail/submesh.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace dynasurf::mesh {

TriMesh submesh(const TriMesh& mesh, std::span<const std::uint8_t> kept) {
  constexpr std::uint32_t none = 0xffffffff;
  TriMesh m;
  std::vector<std::uint32_t> id(mesh.vertices.size(), none);
  for (std::size_t t = 0; t < kept.size(); ++t) {
    if (!kept[t]) continue;
    auto corners = mesh.triangles[t];
    for (std::uint32_t& v : corners) {
      if (id[v] == none) {
        id[v] = m.vertices.size();
        m.vertices.push_back(mesh.vertices[v]);
      }
      v = id[v];
    }
    m.triangles.push_back(corners);
  }
  return m;
}

std::vector<std::uint32_t> components_of(const TriMesh& mesh, std::uint32_t& count) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : {t[1], t[2]}) {
      const std::uint32_t a = find(t[0]), b = find(v);
      parent[std::max(a, b)] = std::min(a, b);
    }
  constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::uint32_t> number(mesh.vertices.size(), none), component(mesh.triangles.size());
  count = 0;
  for (std::size_t t = 0; t < component.size(); ++t) {
    std::uint32_t& n = number[find(mesh.triangles[t][0])];
    if (n == none) n = count++;
    component[t] = n;
  }
  return component;
}

}  // namespace dynasurf::mesh
