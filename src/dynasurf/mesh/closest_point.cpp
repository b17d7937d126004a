#include "dynasurf/mesh/closest_point.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "dynasurf/core/detail/lanes.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::mesh {
namespace {

constexpr std::uint32_t triangles_a_leaf = 4;

SurfacePoint on_segment(const Vec3& p, const Vec3& a, const Vec3& b, int ia, int ib, std::uint32_t id) {
  const Vec3 d = b - a;
  const double length2 = d.squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - a).dot(d) / length2, 0.0, 1.0) : 0.0;
  SurfacePoint s{id, {0, 0, 0}, (a + t * d - p).squaredNorm()};
  s.weights[ia] = 1 - t;
  s.weights[ib] += t;
  return s;
}

/// The largest float below another; `std::nextafter` is a call.
float before(float f) {
  if (f == 0) return -std::numeric_limits<float>::denorm_min();
  const auto bits = std::bit_cast<std::uint32_t>(f);
  return std::bit_cast<float>(f > 0 ? bits - 1 : bits + 1);
}

float rounded_down(double x) {
  const float f = x;
  return f > x ? before(f) : f;
}

float rounded_up(double x) { return -rounded_down(-x); }

using Four = simd::Pack<float, 4, 4>;

/// A place, rounded down and up, as boxes are compared with it.
struct RoundedPlace {
  std::array<Four, 3> below, above;
};

/// Squared distances of a place to four boxes, none larger than the true one: the place and the boxes are given rounded
/// to the side that brings them nearer, and the rounding of the sums is taken off.
std::array<float, 4> least_distances2(const std::array<std::array<float, 4>, 3>& low,
                                      const std::array<std::array<float, 4>, 3>& high, const RoundedPlace& place) {
  Four sum(0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Four under = simd::load<Four>(low[axis].data()) - place.above[axis];
    const Four over = place.below[axis] - simd::load<Four>(high[axis].data());
    const Four d = simd::larger(simd::larger(under, over), Four(0));
    sum += d * d;
  }
  const Four most(std::numeric_limits<float>::max());
  sum *= Four(1 - 1e-6f);
  std::array<float, 4> distance2;
  simd::store(distance2.data(), simd::where_greater(sum, most, most, sum));
  return distance2;
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

ClosestPoint::ClosestPoint(const TriMesh& mesh) : mesh_(mesh) {
  const std::size_t count = mesh.triangles.size();
  if (count == 0) return;
  while ((count >> 2 * depth_) > triangles_a_leaf) ++depth_;
  faces_.reserve(count);
  for (const std::uint32_t t : sorted()) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c], n = (q - p).cross(r - p);
    faces_.push_back({p, q, r, n, n.squaredNorm(), t});
  }
  const std::size_t leaves = std::size_t{1} << 2 * depth_, inner = (leaves - 1) / (ways - 1);
  std::vector<Eigen::AlignedBox3d> boxes(inner + leaves);
  for (std::size_t leaf = 0; leaf < leaves; ++leaf)
    for (std::size_t i = leaf_begin(leaf); i < leaf_begin(leaf + 1); ++i)
      for (const Vec3& corner : {faces_[i].a, faces_[i].b, faces_[i].c}) boxes[inner + leaf].extend(corner);
  nodes_.resize(inner);
  for (std::size_t n = inner; n > 0;) {
    --n;
    for (std::size_t c = 0; c < ways; ++c) {
      const Eigen::AlignedBox3d& box = boxes[ways * n + 1 + c];
      boxes[n].extend(box);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        nodes_[n].low[axis][c] = rounded_down(box.min()[axis]);
        nodes_[n].high[axis][c] = rounded_up(box.max()[axis]);
      }
    }
  }
}

/// The triangles in the order of the leaves: halved, and halved again, across the longest side of their middles.
std::vector<std::uint32_t> ClosestPoint::sorted() const {
  std::vector<std::uint32_t> order(mesh_.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::vector<Vec3> centres(order.size(), Vec3::Zero());
  for (std::size_t t = 0; t < centres.size(); ++t)
    for (const std::uint32_t v : mesh_.triangles[t]) centres[t] += mesh_.vertices[v];
  for (int level = 0; level < 2 * depth_; ++level) {
    const std::size_t parts = std::size_t{1} << level;
    parallel_for(parts, std::max<std::size_t>(1, parts / 64), [&](std::size_t begin, std::size_t end) {
      for (std::size_t m = begin; m < end; ++m) {
        const auto at = [&](std::size_t part, int of) { return order.begin() + (order.size() * part >> of); };
        const auto first = at(m, level), last = at(m + 1, level);
        Eigen::AlignedBox3d spread;
        for (auto i = first; i != last; ++i) spread.extend(centres[*i]);
        Eigen::Index axis = 0;
        spread.sizes().maxCoeff(&axis);
        std::nth_element(first, at(2 * m + 1, level + 1), last, [&](std::uint32_t a, std::uint32_t b) {
          return centres[a][axis] != centres[b][axis] ? centres[a][axis] < centres[b][axis] : a < b;
        });
      }
    });
  }
  // Each library leaves its own order within the parts.
  const std::size_t leaves = std::size_t{1} << (2 * depth_);
  for (std::size_t m = 0; m < leaves; ++m)
    std::sort(order.begin() + (order.size() * m >> 2 * depth_), order.begin() + (order.size() * (m + 1) >> 2 * depth_));
  return order;
}

SurfacePoint ClosestPoint::from_guess(const Vec3& p, std::uint32_t guess) const {
  if (guess == SurfacePoint::none) return (*this)(p);
  const auto& [a, b, c] = mesh_.triangles[guess];
  const SurfacePoint known = closest_on_triangle(p, mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c], guess);
  const SurfacePoint nearer = (*this)(p, known.distance2);
  return nearer.triangle == SurfacePoint::none ? known : nearer;
}

SurfacePoint ClosestPoint::operator()(const Vec3& p, double limit2) const {
  SurfacePoint best;
  best.distance2 = limit2;
  if (faces_.empty()) return best;
  RoundedPlace place;
  for (int axis = 0; axis < 3; ++axis) {
    place.below[axis] = Four(rounded_down(p[axis]));
    place.above[axis] = Four(rounded_up(p[axis]));
  }
  struct Waiting {
    std::size_t node;
    float distance2;
  };
  const std::size_t inner = nodes_.size();
  // Each level leaves at most three nodes waiting, and quarters the triangles: 16 levels hold any index.
  std::array<Waiting, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, 0};
  while (depth > 0) {
    const Waiting top = stack[--depth];
    if (top.distance2 >= best.distance2) continue;
    if (top.node >= inner) {
      const std::size_t leaf = top.node - inner;
      for (std::size_t i = leaf_begin(leaf); i < leaf_begin(leaf + 1); ++i) {
        const Face& f = faces_[i];
        // No place of the triangle is nearer than its plane.
        const double height = f.normal.dot(p - f.a);
        if (height * height * (1 - 1e-9) > best.distance2 * f.normal2) continue;
        const SurfacePoint s = closest_on_triangle(p, f.a, f.b, f.c, f.id);
        if (s.distance2 < best.distance2) best = s;
      }
      continue;
    }
    const std::array<float, ways> distance2 = least_distances2(nodes_[top.node].low, nodes_[top.node].high, place);
    // Of the children that may hold something nearer, the nearest comes on top.
    const std::size_t others = depth;
    for (std::size_t c = 0; c < ways; ++c) {
      if (distance2[c] >= best.distance2) continue;
      std::size_t k = depth++;
      for (; k > others && stack[k - 1].distance2 < distance2[c]; --k) stack[k] = stack[k - 1];
      stack[k] = {ways * top.node + 1 + c, distance2[c]};
    }
  }
  return best;
}

}  // namespace dynasurf::mesh
