#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/mesh/detail/box_tree.hpp"

namespace dynasurf::mesh {

/// Where a ray meets a triangle.
struct RayHit {
  double distance = 0;  // along the unit direction
  std::uint32_t triangle = 0;
  double u = 0, v = 0;       // the point is (1 - u - v) a + u b + v c of the triangle's corners
  bool from_behind = false;  // the ray leaves the surface there: it runs along the triangle's normal
};

/// A bounding-box tree over the triangles of a mesh, for rays (nearest points: closest_point.hpp). Keeps the corners,
/// not the mesh. Building it costs O(n log n), a question about O(log n).
class RayBvh {
 public:
  explicit RayBvh(const TriMesh& mesh);

  /// The nearest triangle on the ray within [nearest, farthest] (Moeller and Trumbore 1997); edges belong to both of
  /// their triangles, so a closed surface has no gaps. `direction` must be a unit vector. Flat triangles are not hit.
  std::optional<RayHit> first_hit(const Vec3& origin, const Vec3& direction, double nearest = 0,
                                  double farthest = std::numeric_limits<double>::infinity()) const;

 private:
  struct Corners {
    Vec3 a, b, c;
    std::uint32_t triangle;
  };

  BoxTree tree_;
  std::vector<Corners> corners_;  // in the order of the tree
};

/// A surface and the tree of its triangles. Refers to the mesh, which must outlive it.
struct TracedSurface {
  const TriMesh& mesh;
  RayBvh rays;

  TracedSurface(const TriMesh& surface) : mesh(surface), rays(surface) {}
};

}  // namespace dynasurf::mesh
