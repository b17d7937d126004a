#include "dynasurf/mesh/closest_point.hpp"

#include <algorithm>
#include <numeric>

#include "dynasurf/core/error.hpp"

namespace dynasurf {
namespace {

constexpr std::uint32_t leaf_size = 4;

SurfacePoint on_segment(const Vec3& p, const Vec3& a, const Vec3& b, int ia, int ib, std::uint32_t id) {
  const Vec3 d = b - a;
  const double length2 = d.squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - a).dot(d) / length2, 0.0, 1.0) : 0.0;
  SurfacePoint s{id, {0, 0, 0}, (a + t * d - p).squaredNorm()};
  s.weights[static_cast<std::size_t>(ia)] = 1 - t;
  s.weights[static_cast<std::size_t>(ib)] += t;
  return s;
}

}  // namespace

SurfacePoint closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t id) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d00 = ab.squaredNorm(), d01 = ab.dot(ac), d11 = ac.squaredNorm();
  const double e0 = ap.dot(ab), e1 = ap.dot(ac), area2 = d00 * d11 - d01 * d01;
  const double v = d11 * e0 - d01 * e1, w = d00 * e1 - d01 * e0;
  if (area2 > 0 && v >= 0 && w >= 0 && v + w <= area2) {
    SurfacePoint s{id, {1 - (v + w) / area2, v / area2, w / area2}, 0};
    s.distance2 = (ap - s.weights[1] * ab - s.weights[2] * ac).squaredNorm();
    return s;
  }
  // The nearest place lies on an edge that the point is beyond; a flat triangle tells nothing of that.
  const bool is_any = !(area2 > 0);
  SurfacePoint best;
  const auto consider = [&](const SurfacePoint& s) {
    if (s.distance2 < best.distance2) best = s;
  };
  if (is_any || w < 0) consider(on_segment(p, a, b, 0, 1, id));
  if (is_any || v + w > area2) consider(on_segment(p, b, c, 1, 2, id));
  if (is_any || v < 0) consider(on_segment(p, c, a, 2, 0, id));
  return best;
}

ClosestPoint::ClosestPoint(const TriMesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
  if (order_.empty()) return;
  std::iota(order_.begin(), order_.end(), 0u);
  std::vector<Vec3> centres(order_.size());
  for (std::size_t t = 0; t < centres.size(); ++t) {
    centres[t].setZero();
    for (const std::uint32_t v : mesh.triangles[t]) centres[t] += mesh.vertices[v];
  }
  nodes_.reserve(order_.size());
  nodes_.push_back({});
  build(0, 0, static_cast<std::uint32_t>(order_.size()), centres);
  faces_.reserve(order_.size());
  for (const std::uint32_t t : order_) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    faces_.push_back({p, q, r, (q - p).cross(r - p), t});
  }
}

void ClosestPoint::build(std::uint32_t node, std::uint32_t first, std::uint32_t last,
                         const std::vector<Vec3>& centres) {
  Eigen::AlignedBox3d box, spread;
  for (std::uint32_t i = first; i < last; ++i) {
    for (const std::uint32_t v : mesh_.triangles[order_[i]]) box.extend(mesh_.vertices[v]);
    spread.extend(centres[order_[i]]);
  }
  nodes_[node] = {box, first, last - first};
  if (last - first <= leaf_size) return;
  Eigen::Index axis = 0;
  spread.sizes().maxCoeff(&axis);
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](std::uint32_t a, std::uint32_t b) {
                     return centres[a][axis] != centres[b][axis] ? centres[a][axis] < centres[b][axis] : a < b;
                   });
  const auto child = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = child;
  nodes_[node].count = 0;
  nodes_.resize(nodes_.size() + 2);
  build(child, first, middle, centres);
  build(child + 1, middle, last, centres);
}

SurfacePoint ClosestPoint::operator()(const Vec3& p, double limit2) const {
  SurfacePoint best;
  best.distance2 = limit2;
  if (nodes_.empty()) return best;
  struct Waiting {
    std::uint32_t node;
    double distance2;
  };
  // Each level leaves at most one node waiting, and halves the triangles: 32 levels hold any index.
  std::array<Waiting, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, nodes_[0].box.squaredExteriorDistance(p)};
  while (depth > 0) {
    const Waiting top = stack[--depth];
    if (top.distance2 >= best.distance2) continue;
    const Node& n = nodes_[top.node];
    if (n.count > 0) {
      for (std::uint32_t i = n.first; i < n.first + n.count; ++i) {
        const Face& f = faces_[i];
        // No place of the triangle is nearer than its plane.
        const double height = f.normal.dot(p - f.a);
        if (height * height * (1 - 1e-9) > best.distance2 * f.normal.squaredNorm()) continue;
        const SurfacePoint s = closest_on_triangle(p, f.a, f.b, f.c, f.id);
        if (s.distance2 < best.distance2) best = s;
      }
      continue;
    }
    Waiting near{n.first, nodes_[n.first].box.squaredExteriorDistance(p)};
    Waiting far{n.first + 1, nodes_[n.first + 1].box.squaredExteriorDistance(p)};
    if (far.distance2 < near.distance2) std::swap(near, far);
    stack[depth++] = far;
    stack[depth++] = near;
  }
  return best;
}

}  // namespace dynasurf
