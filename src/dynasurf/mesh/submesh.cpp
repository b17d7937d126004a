#include "dynasurf/mesh/submesh.hpp"

#include <vector>

namespace dynasurf {

TriMesh submesh(const TriMesh& mesh, std::span<const std::uint8_t> kept) {
  constexpr std::uint32_t none = 0xffffffff;
  TriMesh m;
  std::vector<std::uint32_t> id(mesh.vertices.size(), none);
  for (std::size_t t = 0; t < kept.size(); ++t) {
    if (!kept[t]) continue;
    auto corners = mesh.triangles[t];
    for (std::uint32_t& v : corners) {
      if (id[v] == none) {
        id[v] = static_cast<std::uint32_t>(m.vertices.size());
        m.vertices.push_back(mesh.vertices[v]);
      }
      v = id[v];
    }
    m.triangles.push_back(corners);
  }
  return m;
}

}  // namespace dynasurf
