#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "dynasurf/cloud/lod.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/mesh/detail/vertex_normals.hpp"

namespace dynasurf::cloud {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge edge_of(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// The two parents of every vertex of a mesh that is `coarse` with each triangle cut in four and the vertices of
/// `coarse` first, which are their own parents. Empty when it is not.
std::vector<Edge> parents_of(const TriMesh& coarse, const TriMesh& fine) {
  const std::uint32_t old_count = coarse.vertices.size();
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

/// The edges that have a triangle on one side only, sorted.
std::vector<Edge> boundary_of(const TriMesh& mesh) {
  std::vector<Edge> all, boundary;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) all.push_back(edge_of(t[i], t[(i + 1) % 3]));
  std::sort(all.begin(), all.end());
  for (std::size_t i = 0, last = 0; i < all.size(); i = last) {
    for (last = i; last < all.size() && all[last] == all[i]; ++last) continue;
    if (last - i == 1) boundary.push_back(all[i]);
  }
  return boundary;
}

Vec3 normal_of(const TriMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
}

/// The nearest point of the surface whose triangle faces along `normal`: on thin parts the nearest of all may lie on
/// the other side. Asked for the few vertices where it does.
mesh::SurfacePoint nearest_that_faces(const TriMesh& mesh, const Vec3& p, const Vec3& normal) {
  mesh::SurfacePoint best;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!(normal_of(mesh, t).dot(normal) > 0)) continue;
    const auto& [a, b, c] = mesh.triangles[t];
    const mesh::SurfacePoint found =
        mesh::closest_on_triangle(p, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], t);
    if (found.distance2 < best.distance2) best = found;
  }
  return best;
}

/// Cuts the triangles of a fine mesh, which leaves its shape as it is, until all corners of each can be sent into one
/// triangle of the coarse mesh. The flat pieces between them then are pieces of the coarse surface. A boundary is sent
/// to the coarse boundary.
class Cutting {
 public:
  Cutting(const TriMesh& coarse, const TriMesh& fine)
      : coarse_(coarse),
        closest_(coarse),
        coarse_boundary_(boundary_of(coarse)),
        mesh_(fine),
        normals_(mesh::vertex_normals(fine)),
        images_(fine.vertices.size()) {
    std::vector<std::uint8_t> on_boundary(images_.size(), 0);
    if (!coarse_boundary_.empty())
      for (const Edge& e : boundary_of(fine)) {
        boundary_.insert(e);
        on_boundary[e.first] = on_boundary[e.second] = 1;
      }
    parallel_for(images_.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v)
        images_[v] = on_boundary[v] ? boundary_image_of(mesh_.vertices[v]) : image_of(mesh_.vertices[v], normals_[v]);
    });
    for (const Corners& t : coarse_.triangles) {
      faces_.push_back(sorted(t));
      for (std::size_t i = 0; i < 3; ++i) faces_.push_back(sorted({t[i], t[(i + 1) % 3], t[(i + 1) % 3]}));
      for (std::size_t i = 0; i < 3; ++i) faces_.push_back(sorted({t[i], t[(i + 1) % 3], t[i]}));
    }
    std::sort(faces_.begin(), faces_.end());
  }

  /// Whether every triangle ends within one of the coarse mesh.
  bool run() {
    // Each halves the edges. Where the sheets of the coarse surface nearly touch, what is nearest jumps between them
    // however short an edge is, and a round leaves no fewer triangles to cut: from then on they are led along the edges
    // of the coarse mesh.
    constexpr int rounds = 7, led_rounds = 16;
    const std::size_t most = 8 * (mesh_.triangles.size() + coarse_.triangles.size());  // what will not end, ends here
    std::size_t bad = mark(), before = 2 * bad;
    int led = 0;
    for (int k = 0; led < led_rounds && mesh_.triangles.size() < most && bad > 0; ++k) {
      led += led > 0 || k >= rounds || bad >= before;
      cut(led > 0);
      before = bad;
      bad = mark();
    }
    return bad == 0;
  }

  TriMesh take_mesh() { return std::move(mesh_); }
  std::vector<std::array<std::uint32_t, 2>> take_cuts() { return std::move(cuts_); }
  std::vector<Vec3> starts() const {
    std::vector<Vec3> starts;
    for (const Image& image : images_) {
      Vec3 place = Vec3::Zero();
      for (std::size_t c = 0; c < 3; ++c) place += image.weights[c] * coarse_.vertices[image.corners[c]];
      starts.push_back(place);
    }
    return starts;
  }

 private:
  using Corners = std::array<std::uint32_t, 3>;
  /// A place on the coarse surface by the vertices of a triangle of it.
  struct Image {
    Corners corners{};
    std::array<double, 3> weights{};
    Vec3 nearest;  // before it was drawn anywhere
  };

  static Corners sorted(Corners c) {
    if (c[1] < c[0]) std::swap(c[0], c[1]);
    if (c[2] < c[1]) std::swap(c[1], c[2]);
    if (c[1] < c[0]) std::swap(c[0], c[1]);
    return c;
  }

  static constexpr double drawn = 0.22;  // below a third, so that one weight at least is left

  /// The nearest place of the coarse boundary, drawn to its vertices like others.
  Image boundary_image_of(const Vec3& place) const {
    double least = std::numeric_limits<double>::infinity(), at = 0;
    Edge edge{0, 0};
    for (const Edge& e : coarse_boundary_) {
      const Vec3 &a = coarse_.vertices[e.first], along = coarse_.vertices[e.second] - a;
      const double t = std::clamp((place - a).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
      const double distance2 = (place - a - t * along).squaredNorm();
      if (distance2 < least) least = distance2, at = t, edge = e;
    }
    const auto [a, b] = edge;
    Image image{{a, b, b}, {}, (1 - at) * coarse_.vertices[a] + at * coarse_.vertices[b]};
    const double t = std::clamp((at - drawn) / (1 - 2 * drawn), 0.0, 1.0);
    image.weights = {1 - t, t, 0};
    return image;
  }

  /// Places near a coarse edge or vertex are drawn onto it and the others spread over what they leave, so that no
  /// triangle of the fine mesh needs to have its edges exactly where the coarse ones are.
  Image image_of(const Vec3& place, const Vec3& normal) const {
    mesh::SurfacePoint on = closest_(place);
    if (normal_of(coarse_, on.triangle).dot(normal) < 0) {
      const mesh::SurfacePoint facing = nearest_that_faces(coarse_, place, normal);
      if (facing.triangle != mesh::SurfacePoint::none) on = facing;
    }
    Image image{coarse_.triangles[on.triangle], {}, Vec3::Zero()};
    for (std::size_t c = 0; c < 3; ++c) image.nearest += on.weights[c] * coarse_.vertices[image.corners[c]];
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += image.weights[c] = std::max(0.0, on.weights[c] - drawn);
    for (double& w : image.weights) w /= sum;
    return image;
  }

  /// Whether one triangle of the coarse mesh, or an edge or vertex of it, holds the images of these vertices.
  bool within_one(std::span<const std::uint32_t> vertices) const {
    Corners used{};
    std::size_t count = 0;
    for (const std::uint32_t v : vertices)
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t corner = images_[v].corners[c];
        if (!(images_[v].weights[c] > 0) ||
            std::find(used.begin(), used.begin() + count, corner) != used.begin() + count)
          continue;
        if (count == used.size()) return false;
        used[count++] = corner;
      }
    for (std::size_t c = count; c < used.size(); ++c) used[c] = used[count - 1];
    return count == 1 || std::binary_search(faces_.begin(), faces_.end(), sorted(used));
  }

  /// Marks the edges to cut, and returns how many triangles do not end within one.
  std::size_t mark() {
    marked_.clear();
    std::size_t bad = 0;
    for (const Corners& t : mesh_.triangles) {
      if (within_one(t)) continue;
      ++bad;
      const std::size_t before = marked_.size();
      for (std::size_t i = 0; i < 3; ++i) {
        const std::array<std::uint32_t, 2> ends{t[i], t[(i + 1) % 3]};
        if (!within_one(ends)) marked_[edge_of(ends[0], ends[1])] = 0;
      }
      if (marked_.size() == before)  // three edges without the triangle between them, or marked from the other side
        for (std::size_t i = 0; i < 3; ++i) marked_[edge_of(t[i], t[(i + 1) % 3])] = 0;
    }
    return bad;
  }

  /// The vertices of the coarse mesh between which an image lies.
  static std::vector<std::uint32_t> support(const Image& image) {
    std::vector<std::uint32_t> corners;
    for (std::size_t c = 0; c < 3; ++c)
      if (image.weights[c] > 0) corners.push_back(image.corners[c]);
    return corners;
  }

  /// Vertices along a way over the coarse edges, of the fewest edges, from a corner of one image to one of another.
  /// Empty when the two lie on different parts of the surface.
  std::vector<std::uint32_t> way_between(const Image& from, const Image& to,
                                         const std::vector<std::vector<std::uint32_t>>& neighbours) const {
    const std::vector<std::uint32_t> ends = support(to);
    std::vector<std::uint32_t> open = support(from);
    std::map<std::uint32_t, std::uint32_t> came_from;
    for (const std::uint32_t v : open) came_from[v] = v;
    for (std::size_t n = 0; n < open.size(); ++n) {
      const std::uint32_t v = open[n];
      if (std::find(ends.begin(), ends.end(), v) != ends.end()) {
        std::vector<std::uint32_t> way{v};
        while (came_from[way.back()] != way.back()) way.push_back(came_from[way.back()]);
        std::reverse(way.begin(), way.end());
        return way;
      }
      for (const std::uint32_t next : neighbours[v])
        if (came_from.emplace(next, v).second) open.push_back(next);
    }
    return {};
  }

  void find_neighbours() {
    neighbours_.resize(coarse_.vertices.size());
    boundary_neighbours_.resize(coarse_.vertices.size());
    for (const Corners& t : coarse_.triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        const Edge e = edge_of(t[i], t[(i + 1) % 3]);
        neighbours_[t[i]].push_back(t[(i + 1) % 3]);
        if (!std::binary_search(coarse_boundary_.begin(), coarse_boundary_.end(), e)) continue;
        neighbours_[t[(i + 1) % 3]].push_back(t[i]);
        boundary_neighbours_[e.first].push_back(e.second);
        boundary_neighbours_[e.second].push_back(e.first);
      }
  }

  /// A coarse vertex half way from one image to another, so that the ways to both have fewer edges.
  std::optional<Image> image_on_the_way(std::uint32_t a, std::uint32_t b, bool on_boundary) {
    const std::array<std::uint32_t, 2> ends{a, b};
    if (within_one(ends)) return std::nullopt;
    if (neighbours_.empty()) find_neighbours();
    const std::vector<std::uint32_t> way =
        way_between(images_[a], images_[b], on_boundary ? boundary_neighbours_ : neighbours_);
    if (way.empty()) return std::nullopt;
    const bool at_vertex = support(images_[a]).size() == 1;
    const std::uint32_t v = way[way.size() == 2 && at_vertex ? 1 : (way.size() - 1) / 2];
    return Image{{v, v, v}, {1, 0, 0}, coarse_.vertices[v]};
  }

  void cut(bool led) {
    for (auto& [edge, middle] : marked_) {
      const auto [a, b] = edge;
      middle = mesh_.vertices.size();
      cuts_.push_back({a, b});
      mesh_.vertices.push_back((mesh_.vertices[a] + mesh_.vertices[b]) / 2);
      normals_.push_back((normals_[a] + normals_[b]).normalized());
      // Between the images of the ends, for what is nearest to a rim or fold of the fine mesh may jump.
      const bool on_boundary = boundary_.erase(edge) > 0;
      if (on_boundary) boundary_.insert({{a, middle}, {b, middle}});
      const std::optional<Image> led_to = led ? image_on_the_way(a, b, on_boundary) : std::nullopt;
      const Vec3 between = (images_[a].nearest + images_[b].nearest) / 2;
      images_.push_back(led_to        ? *led_to
                        : on_boundary ? boundary_image_of(between)
                                      : image_of(between, normals_.back()));
    }
    std::vector<Corners> triangles;
    for (const Corners& t : mesh_.triangles) cut(t, triangles);
    mesh_.triangles = std::move(triangles);
  }

  void cut(Corners t, std::vector<Corners>& into) const {
    const auto middle = [&](std::size_t i) {
      const auto found = marked_.find(edge_of(t[i % 3], t[(i + 1) % 3]));
      return found == marked_.end() ? mesh::SurfacePoint::none : found->second;
    };
    for (std::size_t i = 0; i < 3; ++i) {  // at the first edge that is cut: two triangles, which may be cut again
      const std::uint32_t m = middle(i);
      if (m == mesh::SurfacePoint::none) continue;
      cut({m, t[(i + 2) % 3], t[i]}, into);
      cut({m, t[(i + 1) % 3], t[(i + 2) % 3]}, into);
      return;
    }
    into.push_back(t);
  }

  const TriMesh& coarse_;
  mesh::ClosestPoint closest_;
  std::vector<Edge> coarse_boundary_;
  TriMesh mesh_;
  std::vector<Vec3> normals_;
  std::vector<Image> images_;
  std::vector<std::array<std::uint32_t, 2>> cuts_;
  std::vector<Corners> faces_;  // triangles and edges (either end twice) of the coarse mesh, sorted
  std::map<Edge, std::uint32_t> marked_;
  std::set<Edge> boundary_;  // of the fine mesh as it is cut; empty where the coarse one has none
  // Of the coarse vertices, all and along the boundary; found when a way is asked for.
  std::vector<std::vector<std::uint32_t>> neighbours_, boundary_neighbours_;
};

/// Squared distances from the vertices and the middles of the edges and the triangle to a surface.
std::array<double, 7> distances2(const TriMesh& from, std::size_t triangle, const mesh::ClosestPoint& closest) {
  const auto& [a, b, c] = from.triangles[triangle];
  const Vec3 &p = from.vertices[a], &q = from.vertices[b], &r = from.vertices[c];
  const std::array<Vec3, 7> points{p, q, r, (p + q) / 2, (q + r) / 2, (r + p) / 2, (p + q + r) / 3};
  std::array<double, 7> found{};
  for (std::size_t n = 0; n < 7; ++n) found[n] = closest(points[n]).distance2;
  return found;
}

StartDistance distance_between(const TriMesh& from, const TriMesh& to) {
  const mesh::ClosestPoint closest(to);
  std::vector<std::array<double, 7>> found(from.triangles.size());
  parallel_for(found.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) found[t] = distances2(from, t, closest);
  });
  StartDistance distance;
  for (const auto& seven : found)
    for (const double d2 : seven) {
      distance.mean += std::sqrt(d2) / (7 * found.size());
      distance.largest = std::max(distance.largest, std::sqrt(d2));
    }
  return distance;
}

}  // namespace

LodTransition lod_transition(const TriMesh& coarse, const TriMesh& fine) {
  if (coarse.triangles.empty() || fine.triangles.empty())
    throw InputError("a transition between levels of detail needs two meshes with triangles");
  LodTransition transition;
  if (const std::vector<Edge> parents = parents_of(coarse, fine); !parents.empty()) {
    for (const auto& [a, b] : parents) transition.start.push_back((coarse.vertices[a] + coarse.vertices[b]) / 2);
    transition.fine = fine;
    transition.exact = true;
    return transition;
  }
  Cutting cutting(coarse, fine);
  transition.exact = cutting.run();
  transition.start = cutting.starts();
  transition.fine = cutting.take_mesh();
  transition.cuts = cutting.take_cuts();
  return transition;
}

StartDistance start_distance(const LodTransition& transition, const TriMesh& coarse) {
  if (!parents_of(coarse, transition.fine).empty()) return {};  // middles of edges lie on them
  const TriMesh begin{transition.start, transition.fine.triangles};
  const StartDistance there = distance_between(begin, coarse), back = distance_between(coarse, begin);
  return {(there.mean + back.mean) / 2, std::max(there.largest, back.largest)};
}

TriMesh at_transition(const LodTransition& transition, double t) {
  TriMesh mesh = transition.fine;
  if (t >= 1) return mesh;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    mesh.vertices[v] = (1 - t) * transition.start[v] + t * transition.fine.vertices[v];
  return mesh;
}

}  // namespace dynasurf::cloud
