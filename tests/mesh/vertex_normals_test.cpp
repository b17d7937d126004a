#include "dynasurf/mesh/detail/vertex_normals.hpp"

#include <gtest/gtest.h>

#include "support/shapes.hpp"

namespace dynasurf::mesh {
namespace {

using namespace test_shapes;

TEST(VertexNormals, PointOutOfASphere) {
  const TriMesh ball = icosphere(3);
  for (const auto& normals : {vertex_normals(ball), angle_weighted_normals(ball)})
    for (std::size_t v = 0; v < normals.size(); ++v) {
      EXPECT_GT(normals[v].dot(ball.vertices[v]), 0.999);
      EXPECT_NEAR(normals[v].norm(), 1, 1e-15);
    }
}

TEST(VertexNormals, AreZeroWhereNoTriangleCounts) {
  const TriMesh ball = icosphere(1);
  EXPECT_TRUE(vertex_normals(ball, std::vector<bool>(ball.triangles.size(), false))[0].isZero());
}

TEST(VertexNormals, DoNotDependOnTheUnitOfLength) {
  const TriMesh ball = icosphere(1), tiny = mapped(ball, [](const Vec3&p) { return Vec3(1e-90 * p); });
  const std::vector<Vec3> normals = vertex_normals(ball), of_tiny = vertex_normals(tiny);
  for (std::size_t v = 0; v < normals.size(); ++v) EXPECT_LT((normals[v] - of_tiny[v]).norm(), 1e-12);
}

TEST(AngleWeightedNormals, DoNotDependOnHowACornerIsCut) {
  // Each face of a cube is cut along one diagonal: some corners have two triangles of a face, some one.
  const TriMesh cube = cube_surface(1);
  const std::vector<Vec3> normals = angle_weighted_normals(cube);
  for (std::size_t v = 0; v < normals.size(); ++v)
    EXPECT_LT((normals[v] - cube.vertices[v].normalized()).norm(), 1e-12);
}

}  // namespace
}  // namespace dynasurf::mesh
