#include "dynasurf/mesh/detail/relax.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/symmetric_axes.hpp"
#include "dynasurf/mesh/intersections.hpp"
#include "dynasurf/mesh/simplify.hpp"

namespace dynasurf::mesh {
namespace {

using Corners = SurfaceEditor::Corners;

double radians(double deg) { return deg * std::numbers::pi / 180; }

Vec3 normal_of(const SurfaceEditor& s, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return (s.position(b) - s.position(a)).cross(s.position(c) - s.position(a)).normalized();
}

double sine_of(const SurfaceEditor& s, const Corners& c) {
  return sine_of_smallest_angle(s.position(c[0]), s.position(c[1]), s.position(c[2]));
}

template <class Visit>
void for_ring(const SurfaceEditor& s, std::uint32_t v, const Visit& visit) {
  const std::uint32_t first = s.leaving(v);
  std::uint32_t h = first;
  do {
    if (s.is_alive(h / 3)) visit(h);
    h = s.turned(h);
  } while (h != first);
}

/// Smallest sine around a vertex as it would be at `p`; below 0 when a normal would turn by more than the limit.
double worst_at(const SurfaceEditor& s, std::uint32_t v, const Vec3& p, double turn_limit) {
  double worst = 1;
  for_ring(s, v, [&](std::uint32_t h) {
    const Vec3 &a = s.position(s.to(h)), &b = s.position(s.from(SurfaceEditor::previous(h)));
    const Vec3 before = (a - s.position(v)).cross(b - s.position(v)), after = (a - p).cross(b - p);
    if (before.dot(after) < turn_limit * before.norm() * after.norm()) worst = -1;
    worst = std::min(worst, sine_of_smallest_angle(p, a, b));
  });
  return worst;
}

/// Would the triangles around v, moved to `p`, cut the rest?
bool would_cross(SurfaceEditor& s, CrossingGuard& guard, std::uint32_t v, const Vec3& p) {
  std::vector<std::uint32_t> old;
  std::vector<Corners> fresh;
  for_ring(s, v, [&](std::uint32_t h) {
    old.push_back(h / 3);
    fresh.push_back(s.corners(h / 3));
  });
  const Vec3 before = s.position(v);
  s.position(v) = p;
  const bool crosses = guard.would_cross(fresh, old);
  s.position(v) = before;
  return crosses;
}

void move(SurfaceEditor& s, CrossingGuard& guard, std::uint32_t v, const Vec3& p) {
  s.position(v) = p;
  for_ring(s, v, [&](std::uint32_t h) { guard.update(h / 3); });
}

bool try_flip(SurfaceEditor& s, CrossingGuard& guard, std::uint32_t h, double bend_limit, double gain) {
  if (s.is_boundary_edge(h)) return false;
  const std::uint32_t o = s.twin(h), a = s.from(h), b = s.to(h);
  const std::uint32_t c = s.to(SurfaceEditor::next(h)), d = s.to(SurfaceEditor::next(o));
  const double before = std::min(sine_of(s, {a, b, c}), sine_of(s, {b, a, d}));
  const double after = std::min(sine_of(s, {d, c, a}), sine_of(s, {c, d, b}));
  if (after < gain * before + 1e-6 || !s.can_flip(h)) return false;
  const Vec3 n1 = normal_of(s, a, b, c), n2 = normal_of(s, b, a, d);
  const Vec3 m1 = normal_of(s, d, c, a), m2 = normal_of(s, c, d, b);
  const double bend_before = n1.dot(n2), bend_after = m1.dot(m2);
  if (bend_after < bend_limit && bend_after < bend_before) return false;
  if (bend_before < bend_limit && bend_after < bend_before + 0.05) return false;
  // Both new triangles face where the old ones did: none folds over.
  const Vec3 facing = n1 + n2;
  if (facing.dot(m1) < 0.3 * facing.norm() || facing.dot(m2) < 0.3 * facing.norm()) return false;
  const std::array<Corners, 2> fresh{Corners{d, c, a}, Corners{c, d, b}};
  const std::array<std::uint32_t, 2> old{h / 3, o / 3};
  if (guard.would_cross(fresh, old)) return false;
  s.flip(h);
  guard.update(h / 3);
  guard.update(o / 3);
  return true;
}

int flip_sweeps(SurfaceEditor& s, CrossingGuard& guard, double largest_bend_deg, int sweeps) {
  const double limit = own::cos(radians(largest_bend_deg));
  int all = 0;
  for (int n = 0; n < sweeps; ++n) {
    int flipped = 0;
    for (std::uint32_t h = 0; h < 3 * s.triangle_slots(); ++h)
      if (s.is_edge(h)) flipped += try_flip(s, guard, h, limit, 1.02);
    all += flipped;
    if (flipped == 0) break;
  }
  return all;
}

/// The directions that a vertex must not leave: its normal on a smooth surface, two on an edge, all on a corner.
struct Firm {
  int count = 0;
  Mat3 across = Mat3::Zero();
  Vec3 free(const Vec3& step) const { return step - across * step; }
};

/// Two halves of a fan at this angle spread their normals by this much of the whole to either side.
double spread_of(double sharp_deg) { return own::pow(own::sin(radians(0.5 * sharp_deg)), 2); }

/// Triangles count by their angle at the vertex, so that each face of a corner counts the same however it is cut.
Firm firm_at(const SurfaceEditor& s, std::uint32_t v, double spread) {
  Firm firm;
  if (!(spread < 1)) return firm;
  Mat3 normals = Mat3::Zero();
  double angles = 0;
  for_ring(s, v, [&](std::uint32_t h) {
    const Vec3 a = s.position(s.to(h)) - s.position(v),
               b = s.position(s.from(SurfaceEditor::previous(h))) - s.position(v), n = a.cross(b);
    const double angle = own::atan2(n.norm(), a.dot(b));
    normals += angle * n * n.transpose() / std::max(n.squaredNorm(), 1e-300);
    angles += angle;
  });
  if (!(angles > 0)) return firm;
  const SymmetricAxes axes = symmetric_axes(normals / angles);
  for (int a = 0; a < 3; ++a)
    if (axes.values[a] > spread) {
      ++firm.count;
      firm.across += axes.directions.col(a) * axes.directions.col(a).transpose();
    }
  return firm;
}

/// Tries places along a boundary that goes straight on at a vertex, or nearly so, for a larger smallest angle.
bool try_slide(SurfaceEditor& s, CrossingGuard& guard, std::uint32_t v) {
  constexpr double straight = 0.94;  // cosine of 20 degrees
  const Vec3 p = s.position(v);
  Vec3 after = p, before = p;
  for_ring(s, v, [&](std::uint32_t h) {
    if (s.is_boundary_edge(h)) after = s.position(s.to(h));
    if (const std::uint32_t g = SurfaceEditor::previous(h); s.is_boundary_edge(g)) before = s.position(s.from(g));
  });
  if (!((after - p).dot(p - before) > straight * (after - p).norm() * (p - before).norm())) return false;
  double best = worst_at(s, v, p, -2);
  Vec3 place = p;
  for (const Vec3& end : {before, after})
    for (const double t : {0.1, 0.2, 0.3, 0.4, 0.5}) {
      const Vec3 q = p + t * (end - p);
      if (const double worst = worst_at(s, v, q, 0.5); worst > best + 1e-4) best = worst, place = q;
    }
  if (place == p || would_cross(s, guard, v, place)) return false;
  move(s, guard, v, place);
  return true;
}

/// Tries places around a vertex for a larger smallest angle.
bool try_move(SurfaceEditor& s, CrossingGuard& guard, std::uint32_t v, double spread) {
  if (s.is_on_boundary(v)) return try_slide(s, guard, v);
  const Vec3 p = s.position(v);
  Vec3 normal = Vec3::Zero(), middle = Vec3::Zero();
  double reach = 0, n = 0;
  for_ring(s, v, [&](std::uint32_t h) {
    const Vec3 &a = s.position(s.to(h)), &b = s.position(s.from(SurfaceEditor::previous(h)));
    normal += (a - p).cross(b - p);
    middle += a;
    reach += (a - p).norm();
    n += 1;
  });
  middle /= n;
  reach /= n;
  if (!(normal.norm() > 0)) return false;
  normal.normalize();
  const Vec3 u = normal.unitOrthogonal(), w = normal.cross(u);
  // Places are tried within the tangent plane, so that the surface keeps its shape.
  const Vec3 inward = (middle - p) - (middle - p).dot(normal) * normal;
  const Firm firm = firm_at(s, v, spread);
  double best = worst_at(s, v, p, -2);
  Vec3 place = p;
  const auto consider = [&](const Vec3& aim) {
    const Vec3 q = p + firm.free(aim - p);
    const double worst = worst_at(s, v, q, 0.5);
    if (worst > best + 1e-4) best = worst, place = q;
  };
  for (const double t : {1.0, 0.5, 0.25}) consider(p + t * inward);
  for (double length = 0.3 * reach; length > 0.01 * reach; length *= 0.5) {
    const Vec3 from = place;  // NOLINT(performance-unnecessary-copy-initialization): consider() moves place
    for (int k = 0; k < 8; ++k) {
      const double angle = std::numbers::pi * k / 4;
      consider(from + length * (own::cos(angle) * u + own::sin(angle) * w));
    }
  }
  if (place == p || would_cross(s, guard, v, place)) return false;
  move(s, guard, v, place);
  return true;
}

/// Collapses h to its middle, or to the end that is firmer, when that leaves no angle below the limit, or none below
/// what was there.
bool try_collapse(SurfaceEditor& s, CrossingGuard& guard, std::uint32_t h, double least, double spread) {
  if (!s.can_collapse(h)) return false;
  const std::uint32_t o = s.twin(h), a = s.from(h), b = s.to(h);
  std::vector<std::uint32_t> old{h / 3, o / 3};
  std::vector<Corners> fresh;
  double before = 1;
  for (const std::uint32_t v : {a, b})
    for_ring(s, v, [&](std::uint32_t g) {
      before = std::min(before, sine_of(s, s.corners(g / 3)));
      if (g / 3 == h / 3 || g / 3 == o / 3) return;
      old.push_back(g / 3);
      Corners c = s.corners(g / 3);
      for (std::uint32_t& x : c) x = x == a ? b : x;
      fresh.push_back(c);
    });
  const Vec3 at_a = s.position(a), at_b = s.position(b);
  constexpr int firmest = 4;  // a boundary goes before edges and corners
  const int firm_a = s.is_on_boundary(a) ? firmest : firm_at(s, a, spread).count;
  const int firm_b = s.is_on_boundary(b) ? firmest : firm_at(s, b, spread).count;
  const Vec3 place = firm_a > firm_b ? at_a : firm_b > firm_a ? at_b : Vec3(0.5 * (at_a + at_b));
  double after = 1, turn = 1;
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    const Corners c = s.corners(old[i + 2]);
    const Vec3 n = normal_of(s, c[0], c[1], c[2]);
    s.position(b) = place;
    after = std::min(after, sine_of(s, fresh[i]));
    turn = std::min(turn, n.dot(normal_of(s, fresh[i][0], fresh[i][1], fresh[i][2])));
    s.position(b) = at_b;
  }
  if (turn < 0.5 || (after < least && after <= before)) return false;
  s.position(b) = place;
  const bool crosses = guard.would_cross(fresh, old);
  s.position(b) = at_b;
  if (crosses) return false;
  s.collapse(h, place);
  for_ring(s, b, [&](std::uint32_t g) { guard.update(g / 3); });
  return true;
}

/// Splits the longest edge, measured against the edges around it, whose halves are not ill shaped.
bool split_one(SurfaceEditor& s, CrossingGuard& guard, std::span<const double> sizes, double least) {
  std::vector<std::pair<double, std::uint32_t>> edges;
  for (std::uint32_t h = 0; h < 3 * s.triangle_slots(); ++h) {
    if (!s.is_edge(h) || s.is_boundary_edge(h)) continue;
    const double wanted =
        s.from(h) < sizes.size() && s.to(h) < sizes.size() ? 0.5 * (sizes[s.from(h)] + sizes[s.to(h)]) : 1e300;
    edges.push_back({-(s.position(s.to(h)) - s.position(s.from(h))).norm() / wanted, h});
  }
  std::sort(edges.begin(), edges.end());
  // The number of triangles is owed: where no edge has well-shaped halves, the best that there are will do.
  for (const double ease : {1.0, 0.5, 0.0})
    for (const auto& [length, h] : edges) {
      const std::uint32_t o = s.twin(h), a = s.from(h), b = s.to(h);
      const std::uint32_t c = s.to(SurfaceEditor::next(h)), d = s.to(SurfaceEditor::next(o));
      const Vec3 middle = 0.5 * (s.position(a) + s.position(b));
      double worst = 1;
      for (const auto& [x, y] : {std::pair{a, c}, {c, b}, {b, d}, {d, a}})
        worst = std::min(worst, sine_of_smallest_angle(middle, s.position(x), s.position(y)));
      if (worst < ease * least) continue;
      const std::uint32_t v = s.split(h, middle);
      for_ring(s, v, [&](std::uint32_t g) { guard.update(g / 3); });
      return true;
    }
  return false;
}

double worst_sine(const SurfaceEditor& s) {
  double worst = 1;
  for (std::uint32_t t = 0; t < s.triangle_slots(); ++t)
    if (s.is_alive(t)) worst = std::min(worst, sine_of(s, s.corners(t)));
  return worst;
}

}  // namespace

int flip_to_larger_angles(SurfaceEditor& surface, double largest_bend_deg, int sweeps) {
  CrossingGuard guard(surface);
  return flip_sweeps(surface, guard, largest_bend_deg, sweeps);
}

std::vector<double> local_sizes(const SurfaceEditor& s, int sweeps) {
  std::vector<double> sizes(s.vertex_slots(), 0);
  for (std::uint32_t v = 0; v < sizes.size(); ++v) {
    if (!s.has_vertex(v)) continue;
    double n = 0;
    for_ring(s, v, [&](std::uint32_t h) {
      sizes[v] += (s.position(s.to(h)) - s.position(v)).norm();
      n += 1;
    });
    sizes[v] /= n;
  }
  for (int k = 0; k < sweeps; ++k) {
    const std::vector<double> before = sizes;
    for (std::uint32_t v = 0; v < sizes.size(); ++v) {
      if (!s.has_vertex(v)) continue;
      double sum = 0, n = 0;
      for_ring(s, v, [&](std::uint32_t h) {
        sum += before[s.to(h)];
        n += 1;
      });
      sizes[v] = 0.5 * (before[v] + sum / n);
    }
  }
  return sizes;
}

void relax(SurfaceEditor& s, std::span<const double> sizes, const ClosestPoint& onto, const TriMesh& onto_mesh,
           int sweeps, double enough_deg, double sharp_deg) {
  const double enough = own::sin(radians(enough_deg));
  const double spread = spread_of(sharp_deg);
  for (int k = 0; k < sweeps; ++k)
    for (std::uint32_t v = 0; v < s.vertex_slots(); ++v) {
      if (!s.has_vertex(v) || s.is_on_boundary(v)) continue;
      const Vec3 p = s.position(v);
      Vec3 sum = Vec3::Zero(), normal = Vec3::Zero();
      double weights = 0;
      for_ring(s, v, [&](std::uint32_t h) {
        const std::uint32_t ia = s.to(h), ib = s.from(SurfaceEditor::previous(h));
        const Vec3 &a = s.position(ia), &b = s.position(ib), n = (a - p).cross(b - p);
        const double size = (sizes[v] + sizes[ia] + sizes[ib]) / 3;
        const double weight = n.norm() / (size * size);
        sum += weight / 3 * (p + a + b);
        weights += weight;
        normal += n;
      });
      if (!(weights > 0) || !(normal.norm() > 0)) continue;
      normal.normalize();
      Vec3 step = sum / weights - p;
      step -= step.dot(normal) * normal;
      const SurfacePoint on = onto(Vec3(p + firm_at(s, v, spread).free(step)));
      const auto& t = onto_mesh.triangles[on.triangle];
      const Vec3 place = on.weights[0] * onto_mesh.vertices[t[0]] + on.weights[1] * onto_mesh.vertices[t[1]] +
                         on.weights[2] * onto_mesh.vertices[t[2]];
      const double worst = worst_at(s, v, place, 0.5);
      if (worst > enough || worst > worst_at(s, v, p, -2)) s.position(v) = place;
    }
}

double improve_smallest_angle(SurfaceEditor& s, double wanted_deg, int rounds, double sharp_deg) {
  const double wanted = own::sin(radians(wanted_deg));
  CrossingGuard guard(s);
  const std::vector<double> sizes = local_sizes(s, 2);
  const std::size_t count = s.triangles();
  for (int round = 0; round < rounds; ++round) {
    bool changed = false;
    const double spread = 2 * round < rounds ? spread_of(sharp_deg) : 1;
    for (std::uint32_t t = 0; t < s.triangle_slots(); ++t) {
      if (!s.is_alive(t) || sine_of(s, s.corners(t)) >= wanted) continue;
      for (std::uint32_t c = 0; c < 3 && s.is_alive(t) && sine_of(s, s.corners(t)) < wanted; ++c)
        changed |= try_flip(s, guard, 3 * t + c, own::cos(radians(round < 2 ? 40 : 70)), 1.02);
      for (std::uint32_t c = 0; c < 3 && s.is_alive(t) && sine_of(s, s.corners(t)) < wanted; ++c)
        changed |= try_move(s, guard, s.corners(t)[c], spread);
      if (round < 2 || sine_of(s, s.corners(t)) >= wanted) continue;
      // A needle: its shortest edge goes. The neighbours may help, too.
      std::uint32_t shortest = 3 * t;
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
        if ((s.position(s.to(h)) - s.position(s.from(h))).norm() <
            (s.position(s.to(shortest)) - s.position(s.from(shortest))).norm())
          shortest = h;
      if (try_collapse(s, guard, shortest, wanted, spread)) {
        changed = true;
        continue;
      }
      for (std::uint32_t c = 0; c < 3; ++c)
        for_ring(s, s.corners(t)[c], [&](std::uint32_t h) { changed |= try_move(s, guard, s.to(h), spread); });
    }
    // A collapse on the boundary takes one triangle, and a split gives two.
    while (s.triangles() + 1 < count && split_one(s, guard, sizes, wanted)) changed = true;
    if (!changed || worst_sine(s) >= wanted) break;
  }
  return own::asin(std::min(1.0, worst_sine(s))) * 180 / std::numbers::pi;
}

std::size_t revert_self_intersections(SurfaceEditor& s, std::span<const Vec3> safe) {
  std::vector<std::uint8_t> back(s.vertex_slots(), 0);
  std::size_t taken = 0;
  for (;;) {
    std::vector<std::uint32_t> slots;
    const TriMesh mesh = s.mesh(&slots);
    const SelfIntersections found = self_intersections(mesh);
    if (found.free()) return taken;
    const std::size_t before = taken;
    const auto take = [&](std::uint32_t v) {
      if (back[v] || s.position(v) == safe[v]) return;
      back[v] = 1;
      s.position(v) = safe[v];
      ++taken;
    };
    std::vector<std::uint32_t> bad;
    const auto note = [&](std::uint32_t t) {
      for (const std::uint32_t v : mesh.triangles[t]) bad.push_back(slots[v]);
    };
    for (const auto& pair : found.pairs) note(pair[0]), note(pair[1]);
    for (const std::uint32_t t : found.flat) note(t);
    for (const std::uint32_t v : bad) take(v);
    for (int ring = 0; taken == before; ++ring) {  // the offenders are back already: their neighbours follow
      std::vector<std::uint32_t> wider;
      for (const std::uint32_t v : bad) for_ring(s, v, [&](std::uint32_t h) { wider.push_back(s.to(h)); });
      std::sort(wider.begin(), wider.end());
      wider.erase(std::unique(wider.begin(), wider.end()), wider.end());
      for (const std::uint32_t v : wider) take(v);
      if (wider.size() == bad.size() || ring > 100) return taken;
      bad = std::move(wider);
    }
  }
}

}  // namespace dynasurf::mesh
