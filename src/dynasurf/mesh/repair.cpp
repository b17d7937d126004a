#include "dynasurf/mesh/repair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "dynasurf/mesh/intersections.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/smooth.hpp"

namespace dynasurf::mesh {
namespace {

using Ring = std::span<const std::uint32_t>;

/// The triangles of each vertex, as the side opposite to it.
struct Fans {
  std::vector<std::uint32_t> first;
  std::vector<std::array<std::uint32_t, 2>> sides;
};

Fans fans_of(const TriMesh& mesh) {
  Fans fans;
  fans.first.assign(mesh.vertices.size() + 1, 0);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) ++fans.first[v + 1];
  std::partial_sum(fans.first.begin(), fans.first.end(), fans.first.begin());
  fans.sides.resize(3 * mesh.triangles.size());
  std::vector<std::uint32_t> next = fans.first;
  for (const auto& t : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c) fans.sides[next[t[c]]++] = {t[(c + 1) % 3], t[(c + 2) % 3]};
  return fans;
}

/// Do the triangles around a vertex hang together by edges through it?
bool is_one_fan(std::span<const std::array<std::uint32_t, 2>> sides) {
  std::vector<std::uint8_t> reached(sides.size(), 0);
  std::vector<std::size_t> open{0};
  reached[0] = 1;
  std::size_t count = 0;
  while (!open.empty()) {
    const auto [a, b] = sides[open.back()];
    open.pop_back();
    ++count;
    for (std::size_t s = 0; s < sides.size(); ++s)
      if (!reached[s] && (sides[s][0] == a || sides[s][1] == a || sides[s][0] == b || sides[s][1] == b)) {
        reached[s] = 1;
        open.push_back(s);
      }
  }
  return count == sides.size();
}

bool has_single_fans(const TriMesh& mesh) {
  const Fans fans = fans_of(mesh);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const std::size_t count = fans.first[v + 1] - fans.first[v];
    if (count > 0 && !is_one_fan(std::span(fans.sides).subspan(fans.first[v], count))) return false;
  }
  return true;
}

Vec3 centroid_of(std::span<const Vec3> p, Ring ring) {
  const double count = ring.size();
  Vec3 centroid = Vec3::Zero();
  for (const std::uint32_t n : ring) centroid += p[n];
  return centroid / count;
}

/// What a place of a vertex is worth: the worst triangle around it, and how far one turns from the fan's normal.
struct Fitness {
  double shape = 1;
  double cosine = 1;
};

Fitness fitness(const Vec3& centre, std::span<const Vec3> p, Ring ring, const Vec3& normal) {
  Fitness worst;
  Vec3 a = p[ring.back()] - centre;
  for (const std::uint32_t n : ring) {
    const Vec3 b = p[n] - centre, cross = a.cross(b);
    const double twice_area = cross.norm(), squares = a.squaredNorm() + b.squaredNorm() + (b - a).squaredNorm();
    worst.shape = std::min(worst.shape, squares > 0 ? 2 * std::sqrt(3.0) * twice_area / squares : 0.0);
    if (twice_area > 0) worst.cosine = std::min(worst.cosine, cross.dot(normal) / twice_area);
    a = b;
  }
  return worst;
}

/// The direction in which the enclosed volume grows; zero where the fan has none.
Vec3 normal_of(std::span<const Vec3> p, Ring ring) {
  Vec3 sum = Vec3::Zero();
  double size = 0;
  const Vec3& origin = p[ring.front()];
  Vec3 a = p[ring.back()] - origin;
  for (const std::uint32_t n : ring) {
    const Vec3 b = p[n] - origin;
    sum += a.cross(b);
    size += a.squaredNorm();
    a = b;
  }
  constexpr double too_flat = 1e-9;
  return sum.norm() > too_flat * size ? Vec3(sum.normalized()) : Vec3(Vec3::Zero());
}

/// Moves a vertex with an ill-shaped triangle as far as that helps.
bool tidy_vertex(Vec3& position, std::span<const Vec3> p, Ring ring, double goal) {
  constexpr double steepest = 0.5;  // cosine of 60 degrees
  const Vec3 normal = normal_of(p, ring);
  const Fitness now = fitness(position, p, ring, normal);
  if (now.shape >= goal) return false;
  Vec3 way = centroid_of(p, ring) - position;
  // Square to the direction in which the volume grows, the enclosed volume stays as it is.
  way -= way.dot(normal) * normal;
  for (double share = 1; share > 0.1; share /= 2) {
    const Vec3 tried = position + share * way;
    const Fitness then = fitness(tried, p, ring, normal);
    if (then.shape <= now.shape || then.cosine < std::min(now.cosine, steepest)) continue;
    position = tried;
    return true;
  }
  return false;
}

void measure_moves(const TriMesh& before, const TriMesh& after, MoveReport& report) {
  for (std::size_t v = 0; v < before.vertices.size(); ++v) {
    const double move = (after.vertices[v] - before.vertices[v]).norm();
    report.vertices_moved += move > 0 ? 1 : 0;
    report.largest_move_mm = std::max(report.largest_move_mm, move);
  }
  report.volume_change_mm3 = volume_mm3(after) - volume_mm3(before);
}

/// Marks also the neighbours of what is marked.
void widen(const TriMesh& mesh, std::vector<std::uint8_t>& marked) {
  std::vector<std::uint8_t> wider = marked;
  for (const auto& [a, b, c] : mesh.triangles)
    if (marked[a] || marked[b] || marked[c]) wider[a] = wider[b] = wider[c] = 1;
  marked.swap(wider);
}

void mark_corners(const TriMesh& mesh, std::uint32_t triangle, std::vector<std::uint8_t>& marked) {
  for (const std::uint32_t v : mesh.triangles[triangle]) marked[v] = 1;
}

SurfaceCheck check_knowing(const SelfIntersections& meeting, const TriMesh& mesh) {
  const Topology t = topology(mesh);
  SurfaceCheck check;
  check.closed = t.boundary_edges == 0 && t.triangles > 0;
  check.manifold = t.non_manifold_edges == 0 && has_single_fans(mesh);
  check.oriented = t.oriented();
  check.self_intersections = meeting.pairs.size();
  check.flat_triangles = meeting.flat.size();
  return check;
}

/// Smooths around what meets until nothing does; `meeting` always tells how `mesh` is.
UntangleReport free_of(SelfIntersections& meeting, TriMesh& mesh, int rounds) {
  constexpr int sweeps = 4, rounds_per_ring = 4, patience = 8;
  UntangleReport report;
  report.found = report.left = meeting.pairs.size() + meeting.flat.size();
  if (report.found == 0) return report;

  const TriMesh before = mesh;
  const SelfIntersections meeting_before = meeting;
  const VertexRings rings = vertex_rings(mesh);
  std::vector<std::uint8_t> active(mesh.vertices.size(), 0);
  std::size_t fewest = report.found;
  for (int fruitless = 0; !meeting.free() && report.rounds < rounds && fruitless < patience; ++fruitless) {
    for (const auto& [s, t] : meeting.pairs) mark_corners(mesh, s, active), mark_corners(mesh, t, active);
    for (const std::uint32_t t : meeting.flat) mark_corners(mesh, t, active);
    if (++report.rounds % rounds_per_ring == 0) widen(mesh, active);
    for (int sweep = 0; sweep < sweeps; ++sweep)
      for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
        if (const Ring ring = rings.of(v); active[v] && !ring.empty())
          mesh.vertices[v] = (mesh.vertices[v] + centroid_of(mesh.vertices, ring)) / 2;
    meeting = self_intersections(mesh);
    const std::size_t left = meeting.pairs.size() + meeting.flat.size();
    if (left < fewest) fewest = left, fruitless = -1;
  }
  if (meeting.free()) {
    report.left = 0;
  } else {
    // A surface that could not be freed is left as it was: its vertices at least are those that were found.
    mesh = before;
    meeting = meeting_before;
  }
  measure_moves(before, mesh, report);
  return report;
}

}  // namespace

MoveReport tidy(TriMesh& mesh, const Tidy& options) {
  Tidy checked = options;
  check_options(checked, "tidy");
  const TriMesh before = mesh;
  const VertexRings rings = vertex_rings(mesh);
  for (int sweep = 0; sweep < options.sweeps; ++sweep) {
    bool has_moved = false;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
      if (const Ring ring = rings.of(v); !ring.empty())
        has_moved |= tidy_vertex(mesh.vertices[v], mesh.vertices, ring, options.shape);
    if (!has_moved) break;
  }
  MoveReport report;
  measure_moves(before, mesh, report);
  return report;
}

UntangleReport untangle(TriMesh& mesh, int rounds) {
  SelfIntersections meeting = self_intersections(mesh);
  return free_of(meeting, mesh, rounds);
}

SurfaceCheck check_surface(const TriMesh& mesh) { return check_knowing(self_intersections(mesh), mesh); }

Repair repair_surface(TriMesh& mesh, const Tidy& options) {
  Repair repair;
  repair.tidied = tidy(mesh, options);
  SelfIntersections meeting = self_intersections(mesh);
  repair.untangled = free_of(meeting, mesh, options.untangle_rounds);
  repair.check = check_knowing(meeting, mesh);
  return repair;
}

}  // namespace dynasurf::mesh
