#include "dynasurf/mesh/simplify.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::mesh {
namespace {

using Corners = SurfaceEditor::Corners;

/// Weighted sum of squared distances to planes: x'Ax - 2 b'x + c.
struct Quadric {
  Mat3 a = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  double c = 0;
  double area = 0;
  void add(const Quadric& q) {
    a += q.a;
    b += q.b;
    c += q.c;
    area += q.area;
  }
  double at(const Vec3& x) const { return std::max(0.0, x.dot(a * x) - 2 * b.dot(x) + c); }
};

Quadric plane_of(const Vec3& p, const Vec3& q, const Vec3& r) {
  const Vec3 n = (q - p).cross(r - p);
  const double area = 0.5 * n.norm();
  Quadric k;
  if (!(area > 0)) return k;
  const Vec3 u = n / (2 * area);
  const double d = u.dot(p);
  return {area * u * u.transpose(), area * d * u, area * d * d, area};
}

/// The edges that may collapse, the cheapest first; of equally cheap ones the first. Each is in it once: one whose cost
/// changes moves from where it is, which is a short way for most. A heap with four branches.
class EdgeQueue {
 public:
  struct Entry {
    double cost;
    std::uint32_t half_edge;
    bool operator<(const Entry& o) const { return cost != o.cost ? cost < o.cost : half_edge < o.half_edge; }
  };

  void fill(std::vector<Entry> entries, std::size_t half_edges) {
    heap_ = std::move(entries);
    place_.assign(half_edges, none);
    for (std::uint32_t i = 0; i < heap_.size(); ++i) place_[heap_[i].half_edge] = i;
    for (std::size_t i = heap_.size() / ways + 1; i > 0;) sink(--i);
  }

  bool empty() const { return heap_.empty(); }

  std::uint32_t take_first() {
    const std::uint32_t first = heap_.front().half_edge;
    remove(first);
    return first;
  }

  void set(const Entry& entry) {
    std::size_t i = place_[entry.half_edge];
    if (i == none) {
      i = heap_.size();
      heap_.push_back(entry);
    }
    put(i, entry);
    settle(i);
  }

  void remove(std::uint32_t half_edge) {
    const std::size_t i = std::exchange(place_[half_edge], none);
    if (i == none) return;
    const Entry last = heap_.back();
    heap_.pop_back();
    if (i == heap_.size()) return;
    put(i, last);
    settle(i);
  }

 private:
  static constexpr std::size_t ways = 4;
  static constexpr std::uint32_t none = 0xffffffff;

  void put(std::size_t i, const Entry& entry) {
    heap_[i] = entry;
    place_[entry.half_edge] = i;
  }

  void settle(std::size_t i) {
    const Entry entry = heap_[i];
    while (i > 0 && entry < heap_[(i - 1) / ways]) {
      put(i, heap_[(i - 1) / ways]);
      i = (i - 1) / ways;
    }
    put(i, entry);
    sink(i);
  }

  void sink(std::size_t i) {
    if (i >= heap_.size()) return;
    const Entry entry = heap_[i];
    for (;;) {
      const std::size_t first = ways * i + 1, end = std::min(first + ways, heap_.size());
      if (first >= end) break;
      std::size_t least = first;
      for (std::size_t c = first + 1; c < end; ++c)
        if (heap_[c] < heap_[least]) least = c;
      if (!(heap_[least] < entry)) break;
      put(i, heap_[least]);
      i = least;
    }
    put(i, entry);
  }

  std::vector<Entry> heap_;
  std::vector<std::uint32_t> place_;  // in the heap, per half-edge
};

class Simplifier {
 public:
  Simplifier(SurfaceEditor& surface, const Simplify& options)
      : s_(surface), o_(options), quadrics_(surface.vertex_slots()) {
    if (o_.exact) guard_.emplace(surface);
    for (std::uint32_t t = 0; t < s_.triangle_slots(); ++t) {
      if (!s_.is_alive(t)) continue;
      const Corners c = s_.corners(t);
      const Quadric q = plane_of(s_.position(c[0]), s_.position(c[1]), s_.position(c[2]));
      for (const std::uint32_t v : c) quadrics_[v].add(q);
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
        if (s_.is_boundary_edge(h)) add_boundary(h);
    }
  }

  std::size_t run() {
    // Rules that leave nothing to collapse are eased step by step.
    for (const double ease : {1.0, 0.6, 0.3, 0.05}) {
      least_sine_ = own::sin(ease * o_.smallest_angle_deg * std::numbers::pi / 180);
      pass();
      if (s_.triangles() <= o_.triangles) break;
    }
    return s_.triangles();
  }

 private:
  /// A boundary edge stays where it is by a plane that stands on its triangle.
  void add_boundary(std::uint32_t h) {
    const Vec3 &a = s_.position(s_.from(h)), &b = s_.position(s_.to(h)),
               &c = s_.position(s_.to(SurfaceEditor::next(h)));
    const Vec3 normal = (b - a).cross(c - a).normalized();
    Quadric q = plane_of(a, b, Vec3(a + (b - a).norm() * normal));
    q.area = 0;  // it holds, and is no surface
    for (const std::uint32_t v : {s_.from(h), s_.to(h)}) quadrics_[v].add(q);
  }

  void pass() {
    std::vector<std::uint32_t> edges;
    for (std::uint32_t h = 0; h < 3 * s_.triangle_slots(); ++h)
      if (s_.is_edge(h)) edges.push_back(h);
    std::vector<EdgeQueue::Entry> all(edges.size());
    parallel_for(all.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) all[i] = candidate(edges[i]);
    });
    queue_.fill(std::move(all), 3 * s_.triangle_slots());
    while (s_.triangles() > o_.triangles && !queue_.empty()) {
      const std::uint32_t h = queue_.take_first();
      if (!s_.can_collapse(h)) continue;
      const Vec3 place = place_for(h, both(h));
      if (is_allowed(h, place)) collapse(h, place);
    }
  }

  Quadric both(std::uint32_t h) const {
    Quadric q = quadrics_[s_.from(h)];
    q.add(quadrics_[s_.to(h)]);
    return q;
  }

  Vec3 place_for(std::uint32_t h, const Quadric& q) const {
    const Vec3 &a = s_.position(s_.from(h)), &b = s_.position(s_.to(h)), middle = 0.5 * (a + b);
    const bool is_a_firm = s_.is_on_boundary(s_.from(h)), is_b_firm = s_.is_on_boundary(s_.to(h));
    if (is_a_firm != is_b_firm) return is_a_firm ? a : b;
    // Where the planes leave a direction free, the place is the middle of the edge.
    const double hold = 1e-5 * q.area;
    const Mat3 firm = q.a + hold * Mat3::Identity();
    const Vec3 place = firm.inverse() * (q.b + hold * middle);
    return place.allFinite() && (place - middle).squaredNorm() < (b - a).squaredNorm() ? place : middle;
  }

  EdgeQueue::Entry candidate(std::uint32_t h) const {
    const Quadric q = both(h);
    const double length2 = (s_.position(s_.to(h)) - s_.position(s_.from(h))).squaredNorm();
    return {q.at(place_for(h, q)) + o_.evenness * q.area * length2, h};
  }

  /// The triangles around both ends, and what they would become.
  void gather(std::uint32_t h, std::vector<std::uint32_t>& old, std::vector<Corners>& fresh) const {
    const std::uint32_t o = s_.twin(h), a = s_.from(h), b = s_.to(h);
    old.assign({h / 3, o / 3});
    fresh.clear();
    const auto take = [&](std::uint32_t t) {
      if (!s_.is_alive(t)) return;
      old.push_back(t);
      Corners c = s_.corners(t);
      for (std::uint32_t& v : c) v = v == a ? b : v;
      fresh.push_back(c);
    };
    for (std::uint32_t g = s_.turned(h); g != h; g = s_.turned(g))
      if (g / 3 != o / 3) take(g / 3);
    for (std::uint32_t g = s_.turned(o); g != o; g = s_.turned(g))
      if (g / 3 != h / 3) take(g / 3);
  }

  double worst_sine(const std::vector<std::uint32_t>& triangles) const {
    double worst = 1;
    for (const std::uint32_t t : triangles) {
      if (!s_.is_alive(t)) continue;
      const Corners c = s_.corners(t);
      worst = std::min(worst, sine_of_smallest_angle(s_.position(c[0]), s_.position(c[1]), s_.position(c[2])));
    }
    return worst;
  }

  bool is_allowed(std::uint32_t h, const Vec3& place) {
    constexpr std::size_t most_neighbours = 11;
    gather(h, old_, fresh_);
    if (fresh_.size() > most_neighbours) return false;
    const std::uint32_t b = s_.to(h);
    const double turn_limit = own::cos(o_.largest_turn_deg * std::numbers::pi / 180);
    const auto at = [&](std::uint32_t v) -> const Vec3& { return v == b ? place : s_.position(v); };
    double worst_after = 1;
    for (std::size_t i = 0; i < fresh_.size(); ++i) {
      const Corners &n = fresh_[i], c = s_.corners(old_[i + 2]);
      const Vec3 after = (at(n[1]) - at(n[0])).cross(at(n[2]) - at(n[0]));
      const Vec3 before = (s_.position(c[1]) - s_.position(c[0])).cross(s_.position(c[2]) - s_.position(c[0]));
      if (after.dot(before) < turn_limit * std::max(after.norm() * before.norm(), 1e-300)) return false;
      worst_after = std::min(worst_after, sine_of_smallest_angle(at(n[0]), at(n[1]), at(n[2])));
    }
    // Slender triangles may stay as slender as they are.
    if (worst_after < least_sine_ && worst_after < worst_sine(old_)) return false;
    if (!guard_) return true;
    const Vec3 before = s_.position(b);
    s_.position(b) = place;
    const bool crosses = guard_->would_cross(fresh_, old_);
    s_.position(b) = before;
    return !crosses;
  }

  void collapse(std::uint32_t h, const Vec3& place) {
    const std::uint32_t a = s_.from(h), b = s_.to(h);
    quadrics_[b].add(quadrics_[a]);
    for (const std::uint32_t t : {h / 3, s_.twin(h) / 3})
      for (std::uint32_t gone = 3 * t; gone < 3 * t + 3; ++gone) queue_.remove(gone);
    s_.collapse(h, place);
    std::uint32_t g = s_.leaving(b);
    do {
      const std::uint32_t other = s_.twin(g);
      for (const std::uint32_t edge : {g, other})
        if (s_.is_edge(edge))
          queue_.set(candidate(edge));
        else
          queue_.remove(edge);
      if (guard_) guard_->update(g / 3);
      g = s_.turned(g);
    } while (g != s_.leaving(b));
  }

  SurfaceEditor& s_;
  const Simplify& o_;
  std::vector<Quadric> quadrics_;
  std::optional<CrossingGuard> guard_;
  EdgeQueue queue_;
  std::vector<std::uint32_t> old_;
  std::vector<Corners> fresh_;
  double least_sine_ = 0;
};

}  // namespace

double sine_of_smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
  const double two_longest = ab * bc * ca / std::max(std::min({ab, bc, ca}), 1e-300);
  return two_longest > 0 ? (b - a).cross(c - a).norm() / std::sqrt(two_longest) : 0;
}

void refine(SurfaceEditor& s, std::size_t triangles) {
  struct Edge {
    double length2;
    std::uint32_t half_edge;
    bool operator<(const Edge& o) const { return length2 != o.length2 ? length2 < o.length2 : half_edge > o.half_edge; }
  };
  const auto length2 = [&](std::uint32_t h) { return (s.position(s.to(h)) - s.position(s.from(h))).squaredNorm(); };
  std::vector<Edge> all;
  for (std::uint32_t h = 0; h < 3 * s.triangle_slots(); ++h)
    if (s.is_edge(h)) all.push_back({length2(h), h});
  std::priority_queue<Edge> longest(std::less<Edge>(), std::move(all));
  while (s.triangles() < triangles && !longest.empty()) {
    const Edge e = longest.top();
    longest.pop();
    if (e.length2 != length2(e.half_edge)) continue;
    const std::uint32_t v =
        s.split(e.half_edge, Vec3(0.5 * (s.position(s.from(e.half_edge)) + s.position(s.to(e.half_edge)))));
    std::uint32_t h = s.leaving(v);
    do {
      // The edges across from v may have changed their half-edges, and would be lost.
      for (const std::uint32_t edge : {h, SurfaceEditor::next(h)})
        if (s.is_alive(edge / 3)) longest.push({length2(edge), edge});
      h = s.turned(h);
    } while (h != s.leaving(v));
  }
}

std::size_t simplify(SurfaceEditor& surface, const Simplify& options) { return Simplifier(surface, options).run(); }

}  // namespace dynasurf::mesh
