#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf {

/// A point of a mesh: the corners of its triangle weighted, and the squared distance to the point that was asked for.
struct SurfacePoint {
  static constexpr std::uint32_t none = 0xffffffff;
  std::uint32_t triangle = none;
  std::array<double, 3> weights{0, 0, 0};  // not negative, sum 1
  double distance2 = std::numeric_limits<double>::infinity();
};

/// The point of the closed triangle a b c that is nearest to p; `triangle` of the answer is `id`. A flat triangle is
/// its longest edge.
SurfacePoint closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t id = 0);

/// Answers which point of a mesh is nearest: exact, by a tree of boxes. Building takes the sorting of the triangles; a
/// question the boxes nearer than the answer. The mesh must outlive it and keep its vertices.
class ClosestPoint {
 public:
  explicit ClosestPoint(const TriMesh& mesh);

  /// The nearest point at a squared distance below `limit2`; of equally near triangles any, but always the same one.
  /// Without any, `triangle` is `none`.
  SurfacePoint operator()(const Vec3& p, double limit2 = std::numeric_limits<double>::infinity()) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t first, count;  // count 0: children at first and first + 1
  };
  void build(std::uint32_t node, std::uint32_t first, std::uint32_t last, const std::vector<Vec3>& centres);

  // What a question needs of a triangle, in the order of the tree.
  struct Face {
    Vec3 a, b, c, normal;
    std::uint32_t id;
  };

  const TriMesh& mesh_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
  std::vector<Face> faces_;
};

}  // namespace dynasurf
