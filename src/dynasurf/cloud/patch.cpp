#include "dynasurf/cloud/detail/patch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_set>

#include <Eigen/SparseCholesky>

#include "dynasurf/core/detail/edge_key.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/mesh/simplify.hpp"

namespace dynasurf::cloud {
namespace {

constexpr std::uint32_t fixed = 0xffffffff;
using Corners = std::array<std::uint32_t, 3>;

Vec3 middle_of(const TriMesh& mesh, const Loop& loop) {
  const double count = loop.size();
  Vec3 sum = Vec3::Zero();
  for (const std::uint32_t v : loop) sum += mesh.vertices[v] / count;
  return sum;
}

void add_fan(TriMesh& mesh, const Loop& loop) {
  const std::uint32_t tip = mesh.vertices.size();
  mesh.vertices.push_back(middle_of(mesh, loop));
  for (std::size_t i = 0; i < loop.size(); ++i) mesh.triangles.push_back({loop[(i + 1) % loop.size()], loop[i], tip});
}

/// With fans over all loops but two.
TriMesh with_fans(TriMesh mesh, std::span<const Loop> loops, std::size_t a, std::size_t b) {
  for (std::size_t i = 0; i < loops.size(); ++i)
    if (i != a && i != b) add_fan(mesh, loops[i]);
  return mesh;
}

class Edges {
 public:
  explicit Edges(const TriMesh& mesh) {
    for (const auto& t : mesh.triangles)
      for (std::size_t c = 0; c < 3; ++c) known_.insert(edge_key(t[c], t[(c + 1) % 3]));
  }
  bool has(std::uint32_t a, std::uint32_t b) const { return known_.contains(edge_key(a, b)); }

 private:
  std::unordered_set<std::uint64_t> known_;
};

/// The triangles between the corners of a loop with the smallest sum of areas (Klincsek 1980); none where every choice
/// would double an edge.
std::vector<Corners> least_area(const TriMesh& mesh, const Loop& loop, const Edges& edges) {
  const std::size_t n = loop.size();
  constexpr double never = std::numeric_limits<double>::infinity();
  std::vector<double> least(n * n, 0);
  std::vector<std::uint32_t> through(n * n, 0);
  const auto at = [&](std::size_t i) -> const Vec3& { return mesh.vertices[loop[i]]; };
  for (std::size_t span = 2; span < n; ++span)
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t k = i + span;
      double& best = least[i * n + k] = never;
      if (span + 1 < n && edges.has(loop[i], loop[k])) continue;
      for (std::size_t j = i + 1; j < k; ++j) {
        const double parts = least[i * n + j] + least[j * n + k];
        if (!(parts < best)) continue;
        const double sum = parts + 0.5 * (at(j) - at(i)).cross(at(k) - at(i)).norm();
        if (sum < best) {
          best = sum;
          through[i * n + k] = j;
        }
      }
    }
  std::vector<Corners> triangles;
  if (!(least[n - 1] < never)) return triangles;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, k] = open.back();
    open.pop_back();
    if (k - i < 2) continue;
    const std::size_t j = through[i * n + k];
    triangles.push_back({loop[k], loop[j], loop[i]});
    open.push_back({i, j});
    open.push_back({j, k});
  }
  return triangles;
}

void add_disc(TriMesh& mesh, const Loop& loop, const Edges& edges) {
  constexpr std::size_t many = 400;  // the effort grows with the cube
  const std::vector<Corners> triangles = loop.size() <= many ? least_area(mesh, loop, edges) : std::vector<Corners>{};
  if (triangles.empty())
    add_fan(mesh, loop);
  else
    mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
}

/// The way through a gap: where it starts and ends, and in which directions.
struct Way {
  Vec3 from, to, leaving, arriving;  // directions of length 1
  double length;

  Way(const Rim& a, const Rim& b)
      : from(a.middle), to(b.middle), leaving(a.aim.normalized()), arriving(-b.aim.normalized()) {
    // As long as the arc of a circle that turns as much.
    const double turn = own::acos(std::clamp(leaving.dot(arriving), -1.0, 1.0));
    length = (to - from).norm() * (turn > 1e-3 ? turn / (2 * own::sin(turn / 2)) : 1);
  }
  Vec3 place(double t) const {
    const double u = 1 - t;
    return (1 + 2 * t) * u * u * from + t * u * u * length * leaving + t * t * (3 - 2 * t) * to -
           t * t * u * length * arriving;
  }
  Vec3 direction(double t) const { return (place(t + 1e-4) - place(t - 1e-4)).normalized(); }
};

/// The share of a loop's length up to each corner.
std::vector<double> shares(const std::vector<Vec3>& loop) {
  std::vector<double> sums{0};
  for (std::size_t i = 0; i < loop.size(); ++i)
    sums.push_back(sums.back() + (loop[(i + 1) % loop.size()] - loop[i]).norm());
  const double whole = sums.back();
  for (double& s : sums) s /= whole;
  return sums;
}

/// Pairs each corner of `a` with one of `b` as far along, from the start that brings them nearest to each other.
/// Numbers do not fall, and go on beyond the end of b.
std::vector<std::size_t> partners(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  const std::vector<double> along_a = shares(a), along_b = shares(b);
  std::vector<std::size_t> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t start = 0; start < b.size(); ++start) {
    std::vector<std::size_t> found;
    double sum = 0;
    for (std::size_t i = 0, j = start; i < a.size(); ++i) {
      const auto along = [&](std::size_t n) {
        return along_b[n % b.size()] - along_b[start] + (n >= b.size() ? 1 : 0);
      };
      while (j + 1 < start + b.size() && along(j + 1) <= along_a[i]) ++j;
      found.push_back(j);
      sum += (a[i] - b[j % b.size()]).norm();
    }
    if (sum < least) {
      least = sum;
      best = std::move(found);
    }
  }
  return best;
}

Mat3 turn(const Vec3& from, const Vec3& to) { return Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix(); }

/// Rings of as many corners as loop a has, along the way, each between the two loops' shapes.
void add_tube(TriMesh& mesh, const Loop& a, Loop b, const Rim& rim_a, const Rim& rim_b, double edge) {
  const Way way(rim_a, rim_b);
  std::reverse(b.begin(), b.end());
  const Vec3 middle = way.direction(0.5);
  const auto in_section = [&](const Loop& loop, const Rim& rim, const Vec3& along) {
    std::vector<Vec3> offsets;
    for (const std::uint32_t v : loop) offsets.push_back(turn(along, middle) * (mesh.vertices[v] - rim.middle));
    return offsets;
  };
  std::vector<Vec3> of_a = in_section(a, rim_a, way.leaving), of_b = in_section(b, rim_b, way.arriving);
  const std::vector<std::size_t> partner = partners(of_a, of_b);
  const std::size_t n = a.size();
  const int rings = std::clamp(way.length / edge, 2.0, 400.0);
  Loop last = a;
  for (int r = 1; r < rings; ++r) {
    const double t = 1.0 * r / rings;
    const Mat3 turned = turn(middle, way.direction(t));
    Loop ring;
    for (std::size_t i = 0; i < n; ++i) {
      ring.push_back(mesh.vertices.size());
      mesh.vertices.push_back(way.place(t) + turned * ((1 - t) * of_a[i] + t * of_b[partner[i] % b.size()]));
    }
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t k = (i + 1) % n;
      mesh.triangles.push_back({last[k], last[i], ring[i]});
      mesh.triangles.push_back({last[k], ring[i], ring[k]});
    }
    last = std::move(ring);
  }
  // The last ring steps along loop b, each corner to its partner.
  for (std::size_t i = 0, j = partner[0]; i < n; ++i) {
    const std::size_t k = (i + 1) % n, until = k == 0 ? partner[0] + b.size() : partner[k];
    mesh.triangles.push_back({last[k], last[i], b[j % b.size()]});
    for (; j < until; ++j) mesh.triangles.push_back({b[j % b.size()], b[(j + 1) % b.size()], last[k]});
  }
}

std::vector<std::uint32_t> ring_of(const mesh::SurfaceEditor& s, std::uint32_t v) {
  std::vector<std::uint32_t> ring;
  std::uint32_t h = s.leaving(v);
  do {
    ring.push_back(s.to(h));
    h = s.turned(h);
  } while (h != s.leaving(v));
  return ring;
}

bool is_inner(const Patch& p, std::uint32_t h) {
  return h / 3 >= p.first_triangle && p.surface.twin(h) / 3 >= p.first_triangle;
}

double edge_length(const mesh::SurfaceEditor& s, std::uint32_t h) {
  return (s.position(s.from(h)) - s.position(s.to(h))).norm();
}

void split_long(Patch& p, double length) {
  const std::uint32_t half_edges = 3 * p.surface.triangle_slots();
  for (std::uint32_t h = 3 * p.first_triangle; h < half_edges; ++h)
    if (is_inner(p, h) && h < p.surface.twin(h) && edge_length(p.surface, h) > length)
      p.surface.split(h, Vec3(0.5 * (p.surface.position(p.surface.from(h)) + p.surface.position(p.surface.to(h)))));
}

/// `chords`: edges within the patch may join two vertices of its rim.
void flip_to_larger_angles(Patch& p, bool chords) {
  mesh::SurfaceEditor& s = p.surface;
  const std::uint32_t half_edges = 3 * s.triangle_slots();
  for (int sweep = 0; sweep < 3; ++sweep)
    for (std::uint32_t h = 3 * p.first_triangle; h < half_edges; ++h) {
      const std::uint32_t o = s.twin(h);
      if (!is_inner(p, h) || h > o || !s.can_flip(h)) continue;
      const std::uint32_t across = s.to(mesh::SurfaceEditor::next(h)), beyond = s.to(mesh::SurfaceEditor::next(o));
      if (!chords && std::max(across, beyond) < p.first_vertex) continue;
      const Vec3 &a = s.position(s.from(h)), &b = s.position(s.to(h));
      const Vec3 &c = s.position(across), &d = s.position(beyond);
      const double now = std::min(mesh::sine_of_smallest_angle(a, b, c), mesh::sine_of_smallest_angle(b, a, d));
      const double then = std::min(mesh::sine_of_smallest_angle(a, d, c), mesh::sine_of_smallest_angle(d, b, c));
      if (then > now + 1e-6 && (d - a).cross(c - a).dot((b - d).cross(c - d)) > 0) s.flip(h);
    }
}

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// Least squares for the places of the patch's own vertices. Each row says: the weighted sum of a vertex and its
/// neighbours is this.
class Rows {
 public:
  explicit Rows(Patch& p) : p_(p) {}
  std::uint32_t number(std::uint32_t v) const { return v >= p_.first_vertex ? v - p_.first_vertex : fixed; }
  void start(const Vec3& target) { right_.push_back(target); }
  void add(std::uint32_t v, double weight) {
    if (number(v) == fixed)
      right_.back() -= weight * p_.surface.position(v);
    else
      entries_.emplace_back(right_.size() - 1, number(v), weight);
  }
  /// The vertex is `off` from the mean of its neighbours.
  void add_off_mean(std::uint32_t v, std::span<const std::uint32_t> ring, const Vec3& off) {
    start(off);
    add(v, 1);
    for (const std::uint32_t u : ring) add(u, -1.0 / ring.size());
  }
  bool solve() {
    const std::uint32_t unknowns = p_.surface.vertex_slots() - p_.first_vertex;
    Sparse rows(right_.size(), unknowns);
    rows.setFromTriplets(entries_.begin(), entries_.end());
    Eigen::MatrixX3d target(right_.size(), 3);
    for (std::size_t r = 0; r < right_.size(); ++r) target.row(r) = right_[r].transpose();
    const Sparse square = rows.transpose() * rows;
    const Eigen::SimplicialLDLT<Sparse> solver(square);
    if (solver.info() != Eigen::Success) return false;
    const Eigen::MatrixX3d sums = rows.transpose() * target;
    const Eigen::MatrixX3d places = solver.solve(sums);
    if (!places.allFinite()) return false;
    for (std::uint32_t i = 0; i < unknowns; ++i) p_.surface.position(p_.first_vertex + i) = places.row(i).transpose();
    return true;
  }

 private:
  Patch& p_;
  Triplets entries_;
  std::vector<Vec3> right_;
};

/// Own vertices go where the sum of all squared differences to the mean of the neighbours is smallest.
bool bend_least(Patch& p) {
  Rows rows(p);
  const auto add_row = [&](std::uint32_t v) { rows.add_off_mean(v, ring_of(p.surface, v), Vec3::Zero()); };
  for (const std::uint32_t v : p.rim) add_row(v);
  for (auto v = p.first_vertex; v < p.surface.vertex_slots(); ++v) add_row(v);
  return rows.solve();
}

/// Own vertices go to the mean of their neighbours.
bool pull_tight(Patch& p) {
  Rows rows(p);
  for (auto v = p.first_vertex; v < p.surface.vertex_slots(); ++v)
    rows.add_off_mean(v, ring_of(p.surface, v), Vec3::Zero());
  return rows.solve();
}

/// What the surface around a vertex is like. Means of neighbours instead of cotangents: nothing here fails on slender
/// triangles, and where triangles are even it is as good.
struct Around {
  std::vector<std::uint32_t> ring;
  double area = 0;
  double drop = 0;  // of the neighbours' mean below the vertex, for a mean curvature of 1
  Vec3 normal = Vec3::Zero(), off_mean = Vec3::Zero();
  double curvature() const { return drop > 0 ? off_mean.dot(normal) / drop : 0; }
};

Around around(const mesh::SurfaceEditor& s, std::uint32_t v) {
  Around a;
  a.ring = ring_of(s, v);
  const double share = 1.0 / a.ring.size();
  for (std::size_t k = 0; k < a.ring.size(); ++k) {
    const Vec3 here = s.position(a.ring[k]) - s.position(v),
               next = s.position(a.ring[(k + 1) % a.ring.size()]) - s.position(v);
    const Vec3 facing = here.cross(next);
    a.area += facing.norm() / 6;
    a.normal += facing;
    a.off_mean -= share * here;
    a.drop += 0.5 * share * here.squaredNorm();
  }
  a.normal.normalize();
  return a;
}

/// Mean curvature of the vertices that the patch does not touch, evened out a little; 0 elsewhere. What bends more than
/// `largest` is smaller than the hole and does not go on through it.
std::vector<double> curvature_behind(const Patch& p, double largest) {
  const mesh::SurfaceEditor& s = p.surface;
  std::vector<std::uint8_t> touched(s.vertex_slots(), 0);
  for (std::uint32_t v = p.first_vertex; v < touched.size(); ++v) touched[v] = 1;
  for (const std::uint32_t v : p.rim) touched[v] = 1;
  std::vector<double> curvature(s.vertex_slots(), 0);
  std::vector<std::uint8_t> known(s.vertex_slots(), 0);
  std::vector<std::uint32_t> near;
  std::vector<std::uint32_t> front = p.rim;
  for (int ring = 0; ring < 4; ++ring) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t v : front)
      for (const std::uint32_t u : ring_of(s, v)) {
        if (touched[u] || known[u]) continue;
        known[u] = 1;
        curvature[u] = std::clamp(around(s, u).curvature(), -largest, largest);
        next.push_back(u);
      }
    near.insert(near.end(), next.begin(), next.end());
    front = std::move(next);
  }
  for (int sweep = 0; sweep < 3; ++sweep) {
    const std::vector<double> before = curvature;
    for (const std::uint32_t v : near) {
      double sum = before[v], count = 1;
      for (const std::uint32_t u : ring_of(s, v))
        if (known[u]) sum += before[u], ++count;
      curvature[v] = sum / count;
    }
  }
  return curvature;
}

std::vector<Around> all_around(const Patch& p) {
  std::vector<Around> all;
  for (const std::uint32_t v : p.rim) all.push_back(around(p.surface, v));
  for (auto v = p.first_vertex; v < p.surface.vertex_slots(); ++v) all.push_back(around(p.surface, v));
  return all;
}

/// Mean curvature of rim and own vertices, evened out between each other and with that behind the rim.
std::vector<double> even_curvature(const Patch& p, const std::vector<Around>& all, std::vector<double> curvature) {
  constexpr int sweeps = 60;
  for (std::size_t i = 0; i < all.size(); ++i) curvature[p.vertex(i)] = all[i].curvature();
  std::vector<double> even(all.size());
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      even[i] = 0;
      for (const std::uint32_t u : all[i].ring) even[i] += curvature[u] / all[i].ring.size();
    }
    for (std::size_t i = 0; i < all.size(); ++i) curvature[p.vertex(i)] = even[i];
  }
  return even;
}

/// One step towards the surface with more even curvature, along its present normals.
bool bend_evenly(Patch& p, std::span<const double> behind) {
  const std::vector<Around> all = all_around(p);
  const std::vector<double> wanted = even_curvature(p, all, {behind.begin(), behind.end()});
  Rows rows(p);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Around& a = all[i];
    rows.add_off_mean(p.vertex(i), a.ring, a.drop * wanted[i] * a.normal);
  }
  return rows.solve();
}

double bending_of(const Patch& p) {
  double sum = 0;
  for (const Around& a : all_around(p)) sum += a.area * a.curvature() * a.curvature();
  return sum;
}

/// How the vertices of a disc are placed, and whether its edges may join two vertices of the rim.
struct Filling {
  bool (*place)(Patch&);
  bool chords;
};
constexpr Filling smooth{bend_least, true};
constexpr Filling flat{pull_tight, false};  // a chord of a ragged rim lies on the wrong side of it

void fill_evenly(Patch& p, double edge, const Filling& filling) {
  constexpr std::size_t many = 6000;
  for (int k = 0; k < 12 && p.surface.vertex_slots() - p.first_vertex < many; ++k) {
    const std::size_t before = p.surface.triangle_slots();
    split_long(p, 1.5 * edge);
    flip_to_larger_angles(p, filling.chords);
    if (p.surface.triangle_slots() == before) break;
  }
  for (int k = 0; k < 3; ++k) {
    if (!filling.place(p)) return;
    if (p.surface.vertex_slots() - p.first_vertex < many) split_long(p, 1.6 * edge);
    flip_to_larger_angles(p, filling.chords);
  }
}

/// Steps that bend the patch more lead away, and are taken back.
void make_fair(Patch& p, double rim) {
  constexpr int steps = 12;
  constexpr double little = 1.05;
  const std::vector<double> behind = curvature_behind(p, 2 * std::numbers::pi / rim);
  p.bending = bending_of(p);
  for (int k = 0; k < steps; ++k) {
    const mesh::SurfaceEditor safe = p.surface;
    const bool is_solved = bend_evenly(p, behind);
    flip_to_larger_angles(p, true);
    const double bending = bending_of(p);
    if (!is_solved || !(bending < little * p.bending)) {
      p.surface = safe;
      return;
    }
    p.bending = bending;
  }
}

}  // namespace

Patch make_flat_lid(const TriMesh& open, std::span<const Loop> loops, std::size_t a) {
  TriMesh closed = with_fans(open, loops, a, a);
  const std::uint32_t first_triangle = closed.triangles.size();
  const std::uint32_t first_vertex = closed.vertices.size();
  add_fan(closed, loops[a]);
  Patch p{mesh::SurfaceEditor(closed), first_vertex, first_triangle, loops[a], 0};
  fill_evenly(p, rims_of(open, loops)[a].length / loops[a].size(), flat);
  return p;
}

Patch make_patch(const TriMesh& open, std::span<const Loop> loops, std::size_t a, std::optional<std::size_t> b) {
  TriMesh closed = with_fans(open, loops, a, b.value_or(a));
  const std::uint32_t first_triangle = closed.triangles.size();
  const std::uint32_t first_vertex = closed.vertices.size();
  const std::vector<Rim> rims = rims_of(open, loops);
  double edge = rims[a].length / loops[a].size();
  Loop rim = loops[a];
  if (b) {
    edge = 0.5 * (edge + rims[*b].length / loops[*b].size());
    rim.insert(rim.end(), loops[*b].begin(), loops[*b].end());
    add_tube(closed, loops[a], loops[*b], rims[a], rims[*b], edge);
  } else {
    add_disc(closed, loops[a], Edges(open));
  }
  Patch p{mesh::SurfaceEditor(closed), first_vertex, first_triangle, rim, 0};
  if (!b) fill_evenly(p, edge, smooth);
  make_fair(p, rims[a].length);
  return p;
}

}  // namespace dynasurf::cloud
