#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

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
  struct Box {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  };
  /// Children follow their parent; `end` tells where to go on when a node is passed over.
  struct Node {
    Box box;
    std::uint32_t first, last, end;
    bool is_leaf;
  };
  struct Corners {
    Vec3 a, b, c;
    std::uint32_t triangle;
  };

  void build(std::uint32_t first, std::uint32_t last);

  std::vector<Corners> corners_;
  std::vector<Node> nodes_;
};

/// Unit normals of the vertices: area-weighted means of their triangles, outwards for a surface whose triangles run
/// counter-clockwise. With `counts`, only triangles for which it is true take part. A vertex of no such triangle, or
/// of triangles that cancel each other, has a zero vector.
std::vector<Vec3> normals_of_vertices(const TriMesh& mesh, const std::vector<bool>& counts = {});

}  // namespace dynasurf::mesh
