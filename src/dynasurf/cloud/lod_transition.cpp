#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "dynasurf/cloud/lod.hpp"
#include "dynasurf/cloud/neighbours.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/closest_point.hpp"

namespace dynasurf {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge edge_of(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// The two parents of every vertex of a mesh that is `coarse` with each triangle cut in four and the vertices of
/// `coarse` first, which are their own parents. Empty when it is not.
std::vector<Edge> parents_of(const TriMesh& coarse, const TriMesh& fine) {
  const auto old_count = static_cast<std::uint32_t>(coarse.vertices.size());
  if (fine.triangles.size() != 4 * coarse.triangles.size() || fine.vertices.size() <= old_count) return {};
  std::map<Edge, std::uint32_t> middle;  // of the coarse edges; set when seen in the fine mesh
  for (const auto& t : coarse.triangles)
    for (std::size_t i = 0; i < 3; ++i) middle[edge_of(t[i], t[(i + 1) % 3])] = 0;
  if (fine.vertices.size() != old_count + middle.size()) return {};

  // A new vertex is a neighbour of exactly two old ones.
  std::vector<Edge> parents(fine.vertices.size(), Edge{old_count, old_count});
  for (std::uint32_t v = 0; v < old_count; ++v) parents[v] = {v, v};
  const auto join = [&](std::uint32_t old_vertex, std::uint32_t new_vertex) {
    Edge& pair = parents[new_vertex];
    if (pair.first == old_vertex || pair.second == old_vertex) return true;
    if (pair.first != old_count && pair.second != old_count) return false;
    (pair.first == old_count ? pair.first : pair.second) = old_vertex;
    return true;
  };
  for (const auto& t : fine.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      if (a < old_count && b < old_count) return {};
      if (a < old_count && !join(a, b)) return {};
      if (b < old_count && !join(b, a)) return {};
    }
  for (std::uint32_t v = old_count; v < fine.vertices.size(); ++v) {
    const auto found = middle.find(edge_of(parents[v].first, parents[v].second));
    if (found == middle.end() || found->second != 0) return {};
    found->second = v;
  }
  return parents;
}

std::vector<Vec3> vertex_normals(const TriMesh& mesh) {
  std::vector<Vec3> sums(mesh.vertices.size(), Vec3::Zero());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 area = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    for (const auto v : {a, b, c}) sums[v] += area;
  }
  return sums;
}

Vec3 normal_of(const TriMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
}

Vec3 place_of(const TriMesh& mesh, const SurfacePoint& p) {
  const auto& t = mesh.triangles[p.triangle];
  return p.weights[0] * mesh.vertices[t[0]] + p.weights[1] * mesh.vertices[t[1]] + p.weights[2] * mesh.vertices[t[2]];
}

/// The nearest point of the surface whose triangle faces along `normal`: on thin parts the nearest of all may lie on
/// the other side. Asked for the few vertices where it does.
SurfacePoint nearest_that_faces(const TriMesh& mesh, const Vec3& p, const Vec3& normal) {
  SurfacePoint best;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!(normal_of(mesh, t).dot(normal) > 0)) continue;
    const auto& [a, b, c] = mesh.triangles[t];
    const SurfacePoint found =
        closest_on_triangle(p, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], static_cast<std::uint32_t>(t));
    if (found.distance2 < best.distance2) best = found;
  }
  return best;
}

std::vector<Vec3> nearest_starts(const TriMesh& coarse, const TriMesh& fine) {
  const ClosestPoint closest(coarse);
  const std::vector<Vec3> normals = vertex_normals(fine);
  std::vector<Vec3> start(fine.vertices.size());
  parallel_for(start.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      SurfacePoint found = closest(fine.vertices[v]);
      if (normal_of(coarse, found.triangle).dot(normals[v]) < 0) {
        const SurfacePoint facing = nearest_that_faces(coarse, fine.vertices[v], normals[v]);
        if (facing.triangle != SurfacePoint::none) found = facing;
      }
      start[v] = place_of(coarse, found);
    }
  });
  return start;
}

/// Every coarse vertex that a fine one can start from without turning away becomes the start of the one nearest to it:
/// else no vertex would stand at the corners and rims of the coarse surface, and they would be missing at t = 0. The
/// closest pairs come first.
void start_at_vertices(const TriMesh& coarse, const TriMesh& fine, std::vector<Vec3>& start) {
  constexpr std::size_t candidates = 8;
  struct Pairing {
    double distance2;
    std::uint32_t corner, vertex;
    bool operator<(const Pairing& o) const {
      return std::tie(distance2, corner, vertex) < std::tie(o.distance2, o.corner, o.vertex);
    }
  };
  const std::vector<Vec3> coarse_normals = vertex_normals(coarse), fine_normals = vertex_normals(fine);
  const Neighbours neighbours(start);
  std::vector<Pairing> pairings;
  for (std::uint32_t c = 0; c < coarse.vertices.size(); ++c) {
    std::array<Neighbours::Found, candidates> found;
    const std::size_t count = neighbours.nearest(coarse.vertices[c], found);
    for (std::size_t n = 0; n < count; ++n)
      if (coarse_normals[c].dot(fine_normals[found[n].index]) > 0)
        pairings.push_back({found[n].distance2, c, found[n].index});
  }
  std::sort(pairings.begin(), pairings.end());
  std::vector<bool> placed(coarse.vertices.size(), false), taken(start.size(), false);
  for (const Pairing& p : pairings) {
    if (placed[p.corner] || taken[p.vertex]) continue;
    placed[p.corner] = taken[p.vertex] = true;
    start[p.vertex] = coarse.vertices[p.corner];
  }
}

/// Squared distances from the vertices and the middles of the edges and the triangle to a surface.
std::array<double, 7> distances2(const TriMesh& from, std::size_t triangle, const ClosestPoint& closest) {
  const auto& [a, b, c] = from.triangles[triangle];
  const Vec3 &p = from.vertices[a], &q = from.vertices[b], &r = from.vertices[c];
  const std::array<Vec3, 7> points{p, q, r, (p + q) / 2, (q + r) / 2, (r + p) / 2, (p + q + r) / 3};
  std::array<double, 7> found{};
  for (std::size_t n = 0; n < 7; ++n) found[n] = closest(points[n]).distance2;
  return found;
}

struct Distance {
  double mean, largest;
};
Distance distance_between(const TriMesh& from, const TriMesh& to) {
  const ClosestPoint closest(to);
  std::vector<std::array<double, 7>> found(from.triangles.size());
  parallel_for(found.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) found[t] = distances2(from, t, closest);
  });
  Distance distance{0, 0};
  for (const auto& seven : found)
    for (const double d2 : seven) {
      distance.mean += std::sqrt(d2) / static_cast<double>(7 * found.size());
      distance.largest = std::max(distance.largest, std::sqrt(d2));
    }
  return distance;
}

}  // namespace

LodTransition lod_transition(const TriMesh& coarse, const TriMesh& fine) {
  if (coarse.triangles.empty() || fine.triangles.empty())
    throw InputError("a transition between levels of detail needs two meshes with triangles");
  LodTransition transition;
  transition.fine = fine;
  if (const std::vector<Edge> parents = parents_of(coarse, fine); !parents.empty()) {
    for (const auto& [a, b] : parents) transition.start.push_back((coarse.vertices[a] + coarse.vertices[b]) / 2);
    transition.exact = true;
    return transition;
  }
  transition.start = nearest_starts(coarse, fine);
  start_at_vertices(coarse, fine, transition.start);
  const TriMesh begin{transition.start, fine.triangles};
  const Distance there = distance_between(begin, coarse), back = distance_between(coarse, begin);
  transition.start_distance = (there.mean + back.mean) / 2;
  transition.largest_start_distance = std::max(there.largest, back.largest);
  return transition;
}

TriMesh at_transition(const LodTransition& transition, double t) {
  TriMesh mesh = transition.fine;
  if (t >= 1) return mesh;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    mesh.vertices[v] = (1 - t) * transition.start[v] + t * transition.fine.vertices[v];
  return mesh;
}

}  // namespace dynasurf
