#include "dynasurf/cloud/detail/loops.hpp"

#include <unordered_set>

#include "dynasurf/core/detail/edge_key.hpp"

namespace dynasurf::cloud {

std::vector<Loop> loops_of(const TriMesh& open) {
  constexpr std::uint32_t none = 0xffffffff;
  std::unordered_set<std::uint64_t> directed;

  for (const auto& t : open.triangles)
    for (std::size_t c = 0; c < 3; ++c) directed.insert(pair_key(t[c], t[(c + 1) % 3]));
  std::vector<std::uint32_t> after(open.vertices.size(), none);
  for (const auto& t : open.triangles)
    for (std::size_t c = 0; c < 3; ++c)
      if (!directed.contains(pair_key(t[(c + 1) % 3], t[c]))) after[t[c]] = t[(c + 1) % 3];
  std::vector<Loop> loops;
  for (std::uint32_t v = 0; v < after.size(); ++v) {
    if (after[v] == none) continue;
    Loop loop;
    for (std::uint32_t at = v; after[at] != none;) {
      loop.push_back(at);
      const std::uint32_t next = after[at];
      after[at] = none;
      at = next;
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

std::vector<Rim> rims_of(const TriMesh& open, std::span<const Loop> loops) {
  std::vector<Vec3> normal(open.vertices.size(), Vec3::Zero());
  for (const auto& [a, b, c] : open.triangles) {
    const Vec3 n = (open.vertices[b] - open.vertices[a]).cross(open.vertices[c] - open.vertices[a]);
    for (const std::uint32_t v : {a, b, c}) normal[v] += n;
  }
  std::vector<Rim> rims;
  for (const Loop& loop : loops) {
    Rim rim;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::uint32_t v = loop[i], w = loop[(i + 1) % loop.size()];
      const Vec3 edge = open.vertices[w] - open.vertices[v];
      rim.middle += edge.norm() * 0.5 * (open.vertices[v] + open.vertices[w]);
      rim.aim += edge.cross((normal[v] + normal[w]).normalized());
      rim.length += edge.norm();
    }
    rim.middle /= rim.length;
    rim.aim /= rim.length;
    rims.push_back(rim);
  }
  return rims;
}

}  // namespace dynasurf::cloud
