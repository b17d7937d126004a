#include "dynasurf/cloud/detail/holes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "dynasurf/cloud/detail/facing.hpp"
#include "dynasurf/cloud/detail/kd_tree.hpp"
#include "dynasurf/cloud/detail/levels.hpp"
#include "dynasurf/cloud/detail/patch.hpp"
#include "dynasurf/cloud/detail/triangle_marks.hpp"
#include "dynasurf/core/detail/edge_key.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/trace.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/detail/submesh.hpp"
#include "dynasurf/mesh/detail/vertex_normals.hpp"
#include "dynasurf/mesh/measures.hpp"

namespace dynasurf::cloud {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double nudge = 0.1;                  // of the level, as `choose_body` tries it
constexpr double same_way = 0.2, alike = 0.5;  // cosines between directions

/// The points of the scan, asked for with a direction: the other side of a thin wall does not hold a surface.
class Scan {
 public:
  explicit Scan(const OrientedPoints& points) : points_(points), neighbours_(points.points) {}

  /// Distance to the nearest point whose direction has a cosine above `least` to this one; infinity when none of those
  /// around does.
  double distance(const Vec3& place, const Vec3& facing, double least) const {
    return distance_facing(neighbours_, place, facing, least, infinite,
                           [&](std::uint32_t i) { return points_.normals[i]; });
  }

 private:
  const OrientedPoints& points_;
  KdTree neighbours_;
};

/// Whether a part of the surface that is worth the effort lies far from the points; a few vertices tell.
bool has_holes(const TriMesh& mesh, const Scan& scan, double reach) {
  constexpr std::size_t step = 4;
  constexpr double worth_it = 0.002;  // of the vertices
  const std::vector<Vec3> normals = mesh::vertex_normals(mesh);
  const std::size_t asked = mesh.vertices.size() / step;
  const double far = parallel_sum(asked, 256, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i)
      sum += scan.distance(mesh.vertices[i * step], normals[i * step], same_way) > reach;
    return sum;
  });
  return far > worth_it * asked;
}

/// The distance of each triangle's corners and middle, the farthest, to the points whose directions have a cosine above
/// `least` to its own.
std::vector<double> distances(const TriMesh& mesh, const Scan& scan, double least) {
  const std::vector<Vec3> normals = mesh::vertex_normals(mesh);
  std::vector<double> of_vertex(mesh.vertices.size()), of_triangle(mesh.triangles.size());
  parallel_for(of_vertex.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) of_vertex[v] = scan.distance(mesh.vertices[v], normals[v], least);
  });
  parallel_for(of_triangle.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
      const double middle = scan.distance((p + q + r) / 3, (q - p).cross(r - p).normalized(), least);
      of_triangle[t] = std::max({of_vertex[a], of_vertex[b], of_vertex[c], middle});
    }
  });
  return of_triangle;
}

/// Small pieces are no ground to build on.
void drop_islands(const TriMesh& mesh, Marks& kept) {
  constexpr std::size_t smallest = 40;
  Groups groups = parts_of(mesh, kept);
  std::vector<std::size_t> size(mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < kept.size(); ++t)
    if (kept[t]) ++size[groups.find(mesh.triangles[t][0])];
  for (std::size_t t = 0; t < kept.size(); ++t)
    if (kept[t] && size[groups.find(mesh.triangles[t][0])] < smallest) kept[t] = 0;
}

/// Triangles that hang on by one edge make holes ragged.
void drop_ears(const TriMesh& mesh, Marks& kept) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> edges;
  for (std::uint32_t t = 0; t < kept.size(); ++t)
    if (kept[t])
      for (std::size_t c = 0; c < 3; ++c) {
        edges.push_back({edge_key(mesh.triangles[t][c], mesh.triangles[t][(c + 1) % 3]), t});
      }
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint8_t> free_edges(kept.size(), 0);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool is_shared = (i > 0 && edges[i - 1].first == edges[i].first) ||
                           (i + 1 < edges.size() && edges[i + 1].first == edges[i].first);
    if (!is_shared && ++free_edges[edges[i].second] == 2) kept[edges[i].second] = 0;
  }
}

/// Marks go on over a few triangles that may have them: the rim of a torn wall is one band, or its two sides hang
/// together.
void grow(const TriMesh& mesh, const Marks& may_be, Marks& marked) {
  constexpr int rings = 4;
  for (int ring = 0; ring < rings; ++ring) {
    Marks corners(mesh.vertices.size(), 0);
    for (std::size_t t = 0; t < marked.size(); ++t)
      if (marked[t])
        for (const std::uint32_t v : mesh.triangles[t]) corners[v] = 1;
    for (std::size_t t = 0; t < marked.size(); ++t)
      for (const std::uint32_t v : mesh.triangles[t])
        if (may_be[t] && corners[v]) marked[t] = 1;
  }
}

/// The triangles that the points hold, without those around holes, which the holes have bent.
Marks held_by_points(const TriMesh& mesh, const Scan& scan, double reach) {
  constexpr double wide = 4;  // holes less wide than this many times the reach close well enough by themselves
  Marks is_far(mesh.triangles.size()), may_be(mesh.triangles.size());
  const std::vector<double> distance = distances(mesh, scan, same_way), strict = distances(mesh, scan, alike);
  for (std::size_t t = 0; t < is_far.size(); ++t) is_far[t] = distance[t] > reach, may_be[t] = strict[t] > reach;
  grow(mesh, may_be, is_far);
  Groups holes = parts_of(mesh, is_far);
  std::vector<Eigen::AlignedBox3d> box(mesh.vertices.size());
  for (std::size_t t = 0; t < is_far.size(); ++t)
    if (is_far[t])
      for (const std::uint32_t v : mesh.triangles[t]) box[holes.find(v)].extend(mesh.vertices[v]);
  Marks kept(mesh.triangles.size(), 1);
  bool any = false;
  for (std::size_t t = 0; t < kept.size(); ++t)
    if (is_far[t] && box[holes.find(mesh.triangles[t][0])].diagonal().norm() > wide * reach) kept[t] = 0, any = true;
  if (!any) return kept;
  drop_touching(mesh, corners_of_dropped(mesh, kept), kept);
  for (int round = 0; round < 3; ++round) drop_ears(mesh, kept);
  drop_pinches(mesh, kept);
  drop_islands(mesh, kept);
  return kept;
}

/// Euler's number of an open surface whose loops are closed by a disc each.
long euler_when_closed(const TriMesh& open, const std::vector<Loop>& loops) {
  return mesh::topology(open).euler + std::ssize(loops);
}

/// A surface, lighter, and what of it the points hold.
struct Held {
  TriMesh whole;
  Marks kept;
  int handles = 0;  // of the kept part
};

Held held_part(const TriMesh& surface, const Scan& scan, double reach) {
  constexpr std::size_t light = 16000;
  mesh::SurfaceEditor lighter(surface);
  if (lighter.triangles() > light) make_lighter(lighter, light);
  Held held{lighter.mesh(), {}, 0};
  held.kept = held_by_points(held.whole, scan, reach);
  const TriMesh open = mesh::submesh(held.whole, held.kept);
  const mesh::Topology top = mesh::topology(open);
  held.handles = top.components - euler_when_closed(open, loops_of(open)) / 2;
  return held;
}

/// How well two rims face each other: 1 where the surface leaves both straight towards the other, 0 where no tube can
/// be. A straight tube of length L around a loop of length l bends by pi^2 L / l; longer than this it costs more than
/// both ends.
double facing(const Rim& a, const Rim& b) {
  constexpr double enough = 0.1, longest = 2;
  const Vec3 gap = b.middle - a.middle, way = gap.normalized();
  if (!(gap.norm() < longest * std::max(a.length, b.length))) return 0;
  if (!(a.aim.dot(way) > enough && b.aim.dot(way) < -enough)) return 0;
  return a.aim.normalized().dot(way) * -b.aim.normalized().dot(way);
}

/// A tube that could be put between two loops. `effort`: how much it bends, against the two pieces that would close the
/// loops apart; more where it changes its width or leaves aslant, for what was one limb goes on as it was.
struct Join {
  std::size_t a, b;
  double effort;
  std::vector<Vec3> corners;  // three to a triangle
};

/// The joins between different pieces that leave the fewest pieces, with the least effort in all. No loop is joined
/// twice.
class Bridges {
 public:
  /// `joins` by rising effort; `piece` of each loop.
  Bridges(const std::vector<Join>& joins, const std::vector<std::uint32_t>& piece)
      : joins_(joins), used_(piece.size(), 0) {
    search(0, piece, 0);
  }
  const std::vector<std::size_t>& best() const { return best_; }

 private:
  void search(std::size_t from, const std::vector<std::uint32_t>& piece, double effort) {
    constexpr int most_steps = 20000;
    if (chosen_.size() > best_.size() || (chosen_.size() == best_.size() && effort < least_)) {
      best_ = chosen_;
      least_ = effort;
    }
    for (std::size_t i = from; i < joins_.size() && ++steps_ < most_steps; ++i) {
      const auto& [a, b, more, corners] = joins_[i];
      if (used_[a] || used_[b] || piece[a] == piece[b]) continue;
      std::vector<std::uint32_t> then = piece;
      std::replace(then.begin(), then.end(), piece[b], piece[a]);
      used_[a] = used_[b] = 1;
      chosen_.push_back(i);
      search(i + 1, then, effort + more);
      chosen_.pop_back();
      used_[a] = used_[b] = 0;
    }
  }

  const std::vector<Join>& joins_;
  Marks used_;
  std::vector<std::size_t> chosen_, best_;
  double least_ = infinite;
  int steps_ = 0;
};

std::vector<Vec3> corners_of(const Patch& p) {
  std::vector<Vec3> corners;
  for (std::uint32_t t = p.first_triangle; t < p.surface.triangle_slots(); ++t)
    if (p.surface.is_alive(t))
      for (const std::uint32_t v : p.surface.corners(t)) corners.push_back(p.surface.position(v));
  return corners;
}

/// Spreads points over triangles. Where points of the scan are near, they alone tell.
void scatter(const std::vector<Vec3>& corners, const Scan& scan, const Holes& options, OrientedPoints& points) {
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    const Vec3 &a = corners[t], u = corners[t + 1] - a, v = corners[t + 2] - a, n = u.cross(v);
    if (!(n.norm() > 0)) continue;
    const double longest = std::sqrt(std::max({u.squaredNorm(), v.squaredNorm(), (v - u).squaredNorm()}));
    const int steps = std::clamp(ceil_int(longest / options.spacing), 1, 64);
    for (int i = 0; i < steps; ++i)
      for (int j = 0; i + j < steps; ++j)
        for (const double third : {1.0 / 3, 2.0 / 3}) {
          if (third > 0.5 && i + j + 1 == steps) continue;
          const Vec3 place = a + ((i + third) * u + (j + third) * v) / steps;
          if (scan.distance(place, n.normalized(), not_against) < options.reach) continue;
          points.points.push_back(place);
          points.normals.push_back(n.normalized());
          points.areas.push_back(0.5 * n.norm() / (steps * steps));
        }
  }
}

/// What is left when all that is made up is taken away, and what could close it.
struct Torn {
  TriMesh open;
  std::vector<Loop> loops;
  std::vector<std::vector<Vec3>> discs;  // of each loop: three corners to a triangle
  std::vector<Join> joins;               // by rising effort
  std::vector<std::size_t> bridges;      // those of the joins that put pieces together again
};

Torn tear(const TriMesh& whole, const Marks& kept) {
  constexpr double most = 3;  // pieces of the scan are more often one body than two
  Torn torn{mesh::submesh(whole, kept), {}, {}, {}, {}};
  const TriMesh& open = torn.open;
  torn.loops = loops_of(open);
  const std::vector<Rim> rims = rims_of(open, torn.loops);
  Groups parts = parts_of(open, Marks(open.triangles.size(), 1));
  std::vector<std::uint32_t> piece;
  std::vector<double> bending;
  for (std::size_t i = 0; i < torn.loops.size(); ++i) {
    const Patch disc = make_patch(open, torn.loops, i);
    torn.discs.push_back(corners_of(disc));
    bending.push_back(disc.bending);
    piece.push_back(parts.find(torn.loops[i].front()));
  }
  for (std::size_t i = 0; i < torn.loops.size(); ++i)
    for (std::size_t j = i + 1; j < torn.loops.size(); ++j) {
      const double facing_each_other = facing(rims[i], rims[j]);
      if (!(facing_each_other > 0)) continue;
      const Patch tube = make_patch(open, torn.loops, i, j);
      const double widening = std::max(rims[i].length, rims[j].length) / std::min(rims[i].length, rims[j].length);
      // The aims of ragged rims are rough: they count little.
      const double effort = tube.bending * widening / own::pow(facing_each_other, 0.25) / (bending[i] + bending[j]);
      if (effort < most) torn.joins.push_back({i, j, effort, corners_of(tube)});
    }
  std::stable_sort(torn.joins.begin(), torn.joins.end(),
                   [](const Join& a, const Join& b) { return a.effort < b.effort; });
  torn.bridges = Bridges(torn.joins, piece).best();
  return torn;
}

/// Keeps what was made up between pieces that no tube puts together again: the rim between both sides of a wall, which
/// would else be closed each by itself, one within the other. Returns whether there was any.
bool keep_between_pieces(const TriMesh& whole, const Torn& torn, Marks& kept) {
  std::vector<std::uint32_t> in_whole(torn.open.vertices.size());
  for (std::size_t t = 0, n = 0; t < kept.size(); ++t)
    if (kept[t]) {
      for (std::size_t c = 0; c < 3; ++c) in_whole[torn.open.triangles[n][c]] = whole.triangles[t][c];
      ++n;
    }
  Groups pieces = parts_of(whole, kept);
  for (const std::size_t n : torn.bridges)
    pieces.join(in_whole[torn.loops[torn.joins[n].a].front()], in_whole[torn.loops[torn.joins[n].b].front()]);
  Marks dropped(kept.size());
  for (std::size_t t = 0; t < kept.size(); ++t) dropped[t] = !kept[t];
  Groups regions = parts_of(whole, dropped);
  constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::uint32_t> piece_of(whole.vertices.size(), none);  // of each region
  Marks is_between(whole.vertices.size(), 0);
  for (const std::uint32_t v : in_whole) {
    std::uint32_t& piece = piece_of[regions.find(v)];
    if (piece != none && piece != pieces.find(v)) is_between[regions.find(v)] = 1;
    piece = pieces.find(v);
  }
  bool any = false;
  for (std::size_t t = 0; t < kept.size(); ++t)
    if (dropped[t] && is_between[regions.find(whole.triangles[t][0])]) kept[t] = 1, any = true;
  return any;
}

/// Closes the holes within the rims of a surface that stays open.
void fill_within_rims(const TriMesh& open, const Scan& scan, const Holes& options, HoleFill& fill) {
  constexpr double shortest_rim = 0.5;  // of the longest of the piece
  const std::vector<Loop> loops = loops_of(open);
  const std::vector<Rim> rims = rims_of(open, loops);
  Groups parts = parts_of(open, Marks(open.triangles.size(), 1));
  std::vector<double> longest(open.vertices.size(), 0);
  for (std::size_t i = 0; i < loops.size(); ++i) {
    double& so_far = longest[parts.find(loops[i].front())];
    so_far = std::max(so_far, rims[i].length);
  }
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (rims[i].length >= shortest_rim * longest[parts.find(loops[i].front())]) continue;
    scatter(corners_of(make_patch(open, loops, i)), scan, options, fill.points);
    ++fill.holes;
  }
}

}  // namespace

std::optional<HoleFill> fill_holes(const IndicatorField& field, const OrientedPoints& points, const Holes& options) {
  const TraceStage noted("inside: holes");
  // Two ends in one hole of the scan are far more often one limb than two that happen to end there.
  constexpr double most_for_handle = 1.8;
  const Scan scan(points);
  const TriMesh surface = body_surface(field, 0, points.points, options.smallest_share);
  if (surface.triangles.empty() || !has_holes(surface, scan, options.reach)) return std::nullopt;
  Held held = held_part(surface, scan, options.reach);
  for (const double level : {-nudge, nudge}) {
    if (held.handles == 0) break;
    Held other = held_part(body_surface(field, level, points.points, options.smallest_share), scan, options.reach);
    if (other.handles < held.handles) held = std::move(other);
  }
  const TriMesh& whole = held.whole;
  Marks& kept = held.kept;
  HoleFill fill;
  if (options.boundary != BoundaryRule::close) {
    const TriMesh open = mesh::submesh(whole, kept);
    fill.one_way = facing_of(open).norm();
    fill.is_open = options.boundary == BoundaryRule::keep || fill.one_way >= open_from;
    if (fill.is_open) {
      fill_within_rims(open, scan, options, fill);
      return fill;
    }
  }
  Torn torn = tear(whole, kept);
  if (keep_between_pieces(whole, torn, kept)) torn = tear(whole, kept);
  if (torn.loops.empty()) return std::nullopt;

  Groups parts = parts_of(torn.open, Marks(torn.open.triangles.size(), 1));
  Marks done(torn.loops.size(), 0);
  const auto put = [&](const Join& join) {
    parts.join(torn.loops[join.a].front(), torn.loops[join.b].front());
    done[join.a] = done[join.b] = 1;
    scatter(join.corners, scan, options, fill.points);
    ++fill.joined;
  };
  for (const std::size_t n : torn.bridges) put(torn.joins[n]);
  for (const Join& join : torn.joins)
    if (options.may_join && !done[join.a] && !done[join.b] && join.effort < most_for_handle) put(join);
  fill.on_tubes = fill.points.points.size();
  for (std::uint32_t v = 0; v < torn.open.vertices.size(); ++v) fill.kind.parts += parts.find(v) == v;
  // A tube in the place of two discs takes two from Euler's number.
  fill.kind.genus = fill.kind.parts - euler_when_closed(torn.open, torn.loops) / 2 + fill.joined;
  for (std::size_t i = 0; i < torn.loops.size(); ++i)
    if (!done[i]) {
      scatter(torn.discs[i], scan, options, fill.points);
      ++fill.holes;
    }
  return fill;
}

}  // namespace dynasurf::cloud
