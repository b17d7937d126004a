#include "dynasurf/cloud/detail/triangle_marks.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace dynasurf::cloud {

Groups::Groups(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

std::uint32_t Groups::find(std::uint32_t i) {
  // Halves the path on its way, so that later looks are short.
  while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
  return i;
}

void Groups::join(std::uint32_t a, std::uint32_t b) {
  a = find(a), b = find(b);
  // The lowest member leads: which one does not depend on the order of the joins.
  parent_[std::max(a, b)] = std::min(a, b);
}

Groups parts_of(const TriMesh& mesh, const Marks& kept) {
  Groups groups(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (kept[t]) {
      groups.join(mesh.triangles[t][0], mesh.triangles[t][1]);
      groups.join(mesh.triangles[t][0], mesh.triangles[t][2]);
    }
  return groups;
}

Vec3 facing_of(const TriMesh& mesh) {
  Vec3 facing = Vec3::Zero();
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 n = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    facing += n;
    area += n.norm();
  }
  return area > 0 ? Vec3(facing / area) : facing;
}

void drop_touching(const TriMesh& mesh, const Marks& of_vertex, Marks& kept) {
  for (std::size_t t = 0; t < kept.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (of_vertex[v]) kept[t] = 0;
}

Marks corners_of_dropped(const TriMesh& mesh, const Marks& kept) {
  Marks marks(mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < kept.size(); ++t)
    if (!kept[t])
      for (const std::uint32_t v : mesh.triangles[t]) marks[v] = 1;
  return marks;
}

void drop_pinches(const TriMesh& mesh, Marks& kept) {
  for (bool any = true; any;) {
    any = false;
    // Around a vertex that is not on a hole, or on one only, the kept triangles make one fan.
    std::vector<std::array<std::uint32_t, 3>> around;  // vertex, first, second neighbour of each corner
    for (std::size_t t = 0; t < kept.size(); ++t)
      if (kept[t])
        for (std::size_t c = 0; c < 3; ++c)
          around.push_back({mesh.triangles[t][c], mesh.triangles[t][(c + 1) % 3], mesh.triangles[t][(c + 2) % 3]});
    std::sort(around.begin(), around.end());
    Marks pinched(mesh.vertices.size(), 0);
    for (std::size_t i = 0, last = 0; i < around.size(); i = last) {
      std::size_t ends = 0;
      for (last = i; last < around.size() && around[last][0] == around[i][0]; ++last) continue;
      for (std::size_t k = i; k < last; ++k)
        ends += std::none_of(around.begin() + i, around.begin() + last,
                             [&](const auto& other) { return other[1] == around[k][2]; });
      if (ends > 1) pinched[around[i][0]] = 1, any = true;
    }
    if (any) drop_touching(mesh, pinched, kept);
  }
}

}  // namespace dynasurf::cloud
