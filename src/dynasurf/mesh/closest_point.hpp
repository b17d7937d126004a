#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::mesh {

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

/// Answers which point of a mesh is nearest: exact, by a tree of boxes, four in each node. Building takes the sorting
/// of the triangles; a question the boxes nearer than the answer. The mesh must outlive it and keep its vertices.
class ClosestPoint {
 public:
  explicit ClosestPoint(const TriMesh& mesh);

  /// The nearest point at a squared distance below `limit2`; of equally near triangles any, but always the same one.
  /// Without any, `triangle` is `none`.
  SurfacePoint operator()(const Vec3& p, double limit2 = std::numeric_limits<double>::infinity()) const;

  /// The nearest point of all; found faster when the triangle `guess` is near it. `none` is no guess.
  SurfacePoint from_guess(const Vec3& p, std::uint32_t guess) const;

 private:
  static constexpr std::size_t ways = 4;
  /// The boxes of four children, rounded outwards. Node n has the children 4 n + 1 to 4 n + 4; leaves follow the nodes.
  struct Node {
    std::array<std::array<float, ways>, 3> low, high;
  };
  /// What a question needs of a triangle, in the order of the tree.
  struct Face {
    Vec3 a, b, c, normal;
    double normal2;
    std::uint32_t id;
  };
  std::vector<std::uint32_t> sorted() const;
  std::size_t leaf_begin(std::size_t leaf) const { return faces_.size() * leaf >> 2 * depth_; }

  const TriMesh& mesh_;
  int depth_ = 0;  // of levels of nodes above the leaves
  std::vector<Node> nodes_;
  std::vector<Face> faces_;
};

}  // namespace dynasurf::mesh
