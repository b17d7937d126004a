#include "dynasurf/cloud/detail/flat_lids.hpp"

#include "dynasurf/cloud/detail/patch.hpp"

namespace dynasurf::cloud {
namespace {

/// The lid's own vertices and triangles, behind those of the surface.
void append(ClosedSurface& closed, const Patch& lid, std::size_t old_vertices) {
  const mesh::SurfaceEditor& s = lid.surface;
  const std::uint32_t first = closed.mesh.vertices.size();
  for (std::uint32_t v = lid.first_vertex; v < s.vertex_slots(); ++v) closed.mesh.vertices.push_back(s.position(v));
  for (std::uint32_t t = lid.first_triangle; t < s.triangle_slots(); ++t) {
    if (!s.is_alive(t)) continue;
    std::array<std::uint32_t, 3> corners = s.corners(t);
    const Vec3 &a = s.position(corners[0]), &b = s.position(corners[1]), &c = s.position(corners[2]);
    const Vec3 facing = (b - a).cross(c - a);
    if (facing.norm() > 0) {
      closed.added.points.push_back((a + b + c) / 3);
      closed.added.normals.push_back(facing.normalized());
      closed.added.areas.push_back(0.5 * facing.norm());
    }
    for (std::uint32_t& v : corners)
      if (v >= old_vertices) v = first + (v - lid.first_vertex);
    closed.mesh.triangles.push_back(corners);
  }
}

}  // namespace

ClosedSurface with_flat_lids(const TriMesh& open) {
  const std::vector<Loop> loops = loops_of(open);
  ClosedSurface closed{open, {}};
  for (std::size_t i = 0; i < loops.size(); ++i) append(closed, make_flat_lid(open, loops, i), open.vertices.size());
  return closed;
}

}  // namespace dynasurf::cloud
