#include "dynasurf/mesh/detail/ray_bvh.hpp"

#include <algorithm>
#include <cmath>

namespace dynasurf::mesh {
namespace {

// Rays through an edge must hit one of its triangles in spite of rounding.
constexpr double edge_slack = 1e-9;

/// Does the ray meet the box between `nearest` and `farthest`? Slabs (Kay and Kajiya 1986).
bool crosses(const Box& box, const Vec3& origin, const Vec3& inverse, double nearest, double farthest) {
  const auto& [low, high] = box;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::isinf(inverse[axis])) {  // a ray along the slab is inside for good or never
      if (origin[axis] < low[axis] || origin[axis] > high[axis]) return false;
      continue;
    }
    double enter = (low[axis] - origin[axis]) * inverse[axis], leave = (high[axis] - origin[axis]) * inverse[axis];
    if (enter > leave) std::swap(enter, leave);
    if (enter > nearest) nearest = enter;
    if (leave < farthest) farthest = leave;
  }
  return nearest <= farthest * (1 + 1e-12) + 1e-12;
}

std::vector<Box> boxes_of(const TriMesh& mesh) {
  std::vector<Box> boxes(mesh.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) boxes[t].hold(mesh.vertices[v]);
  return boxes;
}

}  // namespace

RayBvh::RayBvh(const TriMesh& mesh) : tree_(boxes_of(mesh)) {
  corners_.reserve(mesh.triangles.size());
  for (const std::uint32_t t : tree_.order()) {
    const auto& [a, b, c] = mesh.triangles[t];
    corners_.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], t});
  }
}

std::optional<RayHit> RayBvh::first_hit(const Vec3& origin, const Vec3& direction, double nearest,
                                        double farthest) const {
  const Vec3 inverse = direction.cwiseInverse();
  std::optional<RayHit> best;
  const auto enters = [&](const Box& box) {
    return crosses(box, origin, inverse, nearest, best ? best->distance : farthest);
  };
  tree_.walk(enters, [&](std::uint32_t i) {
    const Corners& t = corners_[i];
    const Vec3 e1 = t.b - t.a, e2 = t.c - t.a, p = direction.cross(e2);
    const double determinant = e1.dot(p);
    if (determinant == 0) return;
    const Vec3 s = origin - t.a, q = s.cross(e1);
    const double u = s.dot(p) / determinant, v = direction.dot(q) / determinant;
    if (u < -edge_slack || v < -edge_slack || u + v > 1 + edge_slack) return;
    const double distance = e2.dot(q) / determinant;
    if (!(distance >= nearest && distance <= farthest)) return;
    if (!best || distance < best->distance || (distance == best->distance && t.triangle < best->triangle))
      best = RayHit{distance, t.triangle, u, v, determinant < 0};
  });
  return best;
}

}  // namespace dynasurf::mesh
