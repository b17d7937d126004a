#include "dynasurf/mesh/detail/ray_bvh.hpp"

#include <algorithm>
#include <cmath>

namespace dynasurf::mesh {
namespace {

constexpr std::uint32_t leaf_size = 4;
// Rays through an edge must hit one of its triangles in spite of rounding.
constexpr double edge_slack = 1e-9;

/// Does the ray meet the box between `nearest` and `farthest`? Slabs (Kay and Kajiya 1986).
bool crosses(const Vec3& low, const Vec3& high, const Vec3& origin, const Vec3& inverse, double nearest,
             double farthest) {
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

}  // namespace

RayBvh::RayBvh(const TriMesh& mesh) {
  corners_.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    corners_.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], static_cast<std::uint32_t>(t)});
  }
  if (!corners_.empty()) build(0, static_cast<std::uint32_t>(corners_.size()));
}

void RayBvh::build(std::uint32_t first, std::uint32_t last) {
  const std::size_t n = nodes_.size();
  Box box, centres;
  for (std::uint32_t i = first; i < last; ++i) {
    const Corners& t = corners_[i];
    const Vec3 low = t.a.cwiseMin(t.b).cwiseMin(t.c), high = t.a.cwiseMax(t.b).cwiseMax(t.c);
    box.low = box.low.cwiseMin(low), box.high = box.high.cwiseMax(high);
    centres.low = centres.low.cwiseMin(low + high), centres.high = centres.high.cwiseMax(low + high);
  }
  nodes_.push_back({box, first, last, 0, last - first <= leaf_size});
  if (last - first > leaf_size) {
    Eigen::Index axis = 0;
    (centres.high - centres.low).maxCoeff(&axis);
    const auto key = [axis](const Corners& t) {
      return std::min({t.a[axis], t.b[axis], t.c[axis]}) + std::max({t.a[axis], t.b[axis], t.c[axis]});
    };
    const std::uint32_t middle = first + (last - first) / 2;
    std::nth_element(corners_.begin() + first, corners_.begin() + middle, corners_.begin() + last,
                     [&](const Corners& s, const Corners& t) {
                       const double a = key(s), b = key(t);
                       return a != b ? a < b : s.triangle < t.triangle;
                     });
    build(first, middle);
    build(middle, last);
  } else {  // each library leaves its own order
    std::sort(corners_.begin() + first, corners_.begin() + last,
              [](const Corners& s, const Corners& t) { return s.triangle < t.triangle; });
  }
  nodes_[n].end = static_cast<std::uint32_t>(nodes_.size());
}

std::optional<RayHit> RayBvh::first_hit(const Vec3& origin, const Vec3& direction, double nearest,
                                        double farthest) const {
  const Vec3 inverse = direction.cwiseInverse();
  std::optional<RayHit> best;
  for (std::uint32_t n = 0; n < nodes_.size();) {
    const Node& node = nodes_[n];
    if (!crosses(node.box.low, node.box.high, origin, inverse, nearest, best ? best->distance : farthest)) {
      n = node.end;
      continue;
    }
    if (node.is_leaf)
      for (std::uint32_t i = node.first; i < node.last; ++i) {
        const Corners& t = corners_[i];
        const Vec3 e1 = t.b - t.a, e2 = t.c - t.a, p = direction.cross(e2);
        const double determinant = e1.dot(p);
        if (determinant == 0) continue;
        const Vec3 s = origin - t.a, q = s.cross(e1);
        const double u = s.dot(p) / determinant, v = direction.dot(q) / determinant;
        if (u < -edge_slack || v < -edge_slack || u + v > 1 + edge_slack) continue;
        const double distance = e2.dot(q) / determinant;
        if (!(distance >= nearest && distance <= farthest)) continue;
        if (!best || distance < best->distance || (distance == best->distance && t.triangle < best->triangle))
          best = RayHit{distance, t.triangle, u, v, determinant < 0};
      }
    ++n;
  }
  return best;
}

std::vector<Vec3> normals_of_vertices(const TriMesh& mesh, const std::vector<bool>& counts) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!counts.empty() && !counts[t]) continue;
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3 n = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    for (const auto v : {a, b, c}) normals[v] += n;
  }
  for (Vec3& n : normals) {
    const double length = n.norm();
    n = length > 0 ? Vec3(n / length) : Vec3::Zero();
  }
  return normals;
}

}  // namespace dynasurf::mesh
