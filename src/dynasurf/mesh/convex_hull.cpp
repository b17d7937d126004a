#include "dynasurf/mesh/detail/convex_hull.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/mesh/detail/predicates.hpp"
#include "dynasurf/mesh/detail/relax.hpp"
#include "dynasurf/mesh/intersections.hpp"
#include "dynasurf/mesh/simplify.hpp"

namespace dynasurf::mesh {
namespace {

using Corners = std::array<std::uint32_t, 3>;

/// A hull that grows by the point farthest outside one of its faces. A point in the plane of a face counts as inside
/// it: where it is outside the hull, a face of another plane sees it. So no new triangle is ever flat.
class Hull {
 public:
  explicit Hull(std::span<const Vec3> points) : points_(points) { begin(); }

  TriMesh run() {
    for (std::uint32_t f = 0; f < faces_.size(); ++f)  // faces are added at the end, so all are met
      while (faces_[f].alive && !faces_[f].outside.empty()) grow(f);
    return mesh();
  }

 private:
  struct Face {
    Corners corners{}, neighbours{};  // neighbour i lies across the edge from corner i to the next
    std::vector<std::uint32_t> outside;
    bool alive = true;
  };

  bool sees(const Face& f, std::uint32_t p) const {
    const auto& [a, b, c] = f.corners;
    return orient3d(points_[a], points_[b], points_[c], points_[p]) < 0;
  }

  /// How far outside, up to a factor that is the same for all points of a face: a guess by rounded numbers.
  double height(const Face& f, std::uint32_t p) const {
    const Vec3& a = points_[f.corners[0]];
    return (points_[f.corners[1]] - a).cross(points_[f.corners[2]] - a).dot(points_[p] - a);
  }

  /// The point with the largest `measure` for which `fits` holds: the largest of all where it fits, else of those.
  template <class Measure, class Fits>
  std::uint32_t largest(const Measure& measure, const Fits& fits) const {
    std::uint32_t best = 0;
    double most = -1;
    for (std::uint32_t p = 0; p < points_.size(); ++p)
      if (const double value = measure(p); value > most && fits(p)) best = p, most = value;
    if (most < 0) throw InputError("a convex hull of points that all lie in one plane");
    return best;
  }

  void begin() {
    for (const Vec3& p : points_)
      if (!p.allFinite()) throw InputError("a convex hull of points that are not finite");
    if (points_.empty()) throw InputError("a convex hull of no points");
    const auto far_from = [&](const Vec3& from, std::uint32_t p) { return (points_[p] - from).squaredNorm(); };
    const std::uint32_t a =
        largest([&](std::uint32_t p) { return far_from(points_[0], p); }, [](std::uint32_t) { return true; });
    const std::uint32_t b = largest([&](std::uint32_t p) { return far_from(points_[a], p); },
                                    [&](std::uint32_t p) { return points_[p] != points_[a]; });
    const Vec3 along = points_[b] - points_[a];
    const std::uint32_t c = largest([&](std::uint32_t p) { return along.cross(points_[p] - points_[a]).squaredNorm(); },
                                    [&](std::uint32_t p) { return !is_flat(points_[a], points_[b], points_[p]); });
    const Vec3 normal = along.cross(points_[c] - points_[a]);
    const std::uint32_t d =
        largest([&](std::uint32_t p) { return std::abs(normal.dot(points_[p] - points_[a])); },
                [&](std::uint32_t p) { return orient3d(points_[a], points_[b], points_[c], points_[p]) != 0; });
    const bool below = orient3d(points_[a], points_[b], points_[c], points_[d]) > 0;
    const std::uint32_t u = below ? b : c, v = below ? c : b;  // d lies under a, u, v
    for (const Corners& corners : {Corners{a, u, v}, Corners{u, a, d}, Corners{v, u, d}, Corners{a, v, d}})
      faces_.push_back({corners, {}, {}, true});
    faces_[0].neighbours = {1, 2, 3};
    faces_[1].neighbours = {0, 3, 2};
    faces_[2].neighbours = {0, 1, 3};
    faces_[3].neighbours = {0, 2, 1};
    std::vector<std::uint32_t> all(points_.size());
    for (std::uint32_t p = 0; p < all.size(); ++p) all[p] = p;
    share_out(all, 0);
  }

  /// Gives each point to the first face from `first` on that sees it; the others are inside for good.
  void share_out(const std::vector<std::uint32_t>& points, std::size_t first) {
    for (const std::uint32_t p : points)
      for (std::size_t f = first; f < faces_.size(); ++f)
        if (sees(faces_[f], p)) {
          faces_[f].outside.push_back(p);
          break;
        }
  }

  /// Takes in the farthest point outside face f: the faces that see it go, and a cone over their rim comes.
  void grow(std::uint32_t f) {
    const std::vector<std::uint32_t>& outside = faces_[f].outside;
    std::uint32_t apex = outside[0];
    for (const std::uint32_t p : outside)
      if (height(faces_[f], p) > height(faces_[f], apex)) apex = p;

    std::vector<std::uint32_t> seen{f}, left;
    faces_[f].alive = false;
    struct RimEdge {
      std::uint32_t from, to, beyond;  // beyond: the face that stays
    };
    std::vector<RimEdge> rim;
    for (std::size_t n = 0; n < seen.size(); ++n) {
      const Face face = std::move(faces_[seen[n]]);
      left.insert(left.end(), face.outside.begin(), face.outside.end());
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t beyond = face.neighbours[i];
        if (!faces_[beyond].alive) continue;
        if (sees(faces_[beyond], apex)) {
          faces_[beyond].alive = false;
          seen.push_back(beyond);
        } else {
          rim.push_back({face.corners[i], face.corners[(i + 1) % 3], beyond});
        }
      }
    }
    const std::size_t first = faces_.size();
    std::vector<std::pair<std::uint32_t, std::uint32_t>> starting;  // rim vertex, the new face whose edge begins there
    for (const RimEdge& edge : rim) {
      const std::uint32_t id = faces_.size();
      starting.emplace_back(edge.from, id);
      faces_.push_back({{edge.from, edge.to, apex}, {edge.beyond, 0, 0}, {}, true});
      Face& beyond = faces_[edge.beyond];
      for (std::size_t i = 0; i < 3; ++i)
        if (beyond.corners[i] == edge.to && beyond.corners[(i + 1) % 3] == edge.from) beyond.neighbours[i] = id;
    }
    std::sort(starting.begin(), starting.end());
    for (std::size_t id = first; id < faces_.size(); ++id) {
      const auto after =
          std::lower_bound(starting.begin(), starting.end(), std::pair{faces_[id].corners[1], 0u})->second;
      faces_[id].neighbours[1] = after;
      faces_[after].neighbours[2] = id;
    }
    left.erase(std::remove(left.begin(), left.end(), apex), left.end());
    share_out(left, first);
  }

  TriMesh mesh() const {
    constexpr std::uint32_t none = 0xffffffff;
    std::vector<std::uint32_t> number(points_.size(), none);
    TriMesh mesh;
    for (const Face& face : faces_) {
      if (!face.alive) continue;
      Corners& triangle = mesh.triangles.emplace_back();
      for (std::size_t i = 0; i < 3; ++i) {
        std::uint32_t& n = number[face.corners[i]];
        if (n == none) {
          n = mesh.vertices.size();
          mesh.vertices.push_back(points_[face.corners[i]]);
        }
        triangle[i] = n;
      }
    }
    return mesh;
  }

  std::span<const Vec3> points_;
  std::vector<Face> faces_;
};

}  // namespace

TriMesh convex_hull(std::span<const Vec3> points) { return Hull(points).run(); }

TriMesh even_hull(std::span<const Vec3> points, std::size_t triangles) {
  const TriMesh hull = convex_hull(points);
  const std::size_t wanted = std::max<std::size_t>(triangles, 20);
  SurfaceEditor surface(hull);
  // Many long triangles meet at the corners of a hull: halving edges and merging the short ones evens them out.
  refine(surface, std::max(4 * wanted, 2 * surface.triangles()));
  simplify(surface, {.triangles = wanted, .evenness = 0.1, .exact = false});
  const ClosestPoint on_hull(hull);
  relax(surface, std::vector<double>(surface.vertex_slots(), 1), on_hull, hull, 10, 30, 30);
  return surface.mesh();
}

}  // namespace dynasurf::mesh
