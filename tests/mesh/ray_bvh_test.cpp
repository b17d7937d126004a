#include "dynasurf/mesh/detail/ray_bvh.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::mesh {
namespace {

/// Fixed directions of all kinds, along axes too.
std::vector<Vec3> directions() {
  std::vector<Vec3> all;
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = -2; z <= 2; ++z)
        if (x != 0 || y != 0 || z != 0) all.push_back(Vec3(x, y, z).normalized());
  return all;
}

std::optional<RayHit> hit_by_trying_all(const TriMesh& mesh, const Vec3& origin, const Vec3& direction) {
  std::optional<RayHit> best;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const TriMesh one{mesh.vertices, {mesh.triangles[t]}};
    const auto hit = RayBvh(one).first_hit(origin, direction);
    if (hit && (!best || hit->distance < best->distance)) best = hit;
  }
  return best;
}

TEST(RayBvh, MeetsWhatTryingEveryTriangleMeets) {
  const TriMesh mesh = icosphere(2);
  const RayBvh tree(mesh);
  for (const Vec3& origin : {Vec3(0, 0, 0), Vec3(0.3, -0.2, 0.5), Vec3(-2, 0.1, 0.05)})
    for (const Vec3& d : directions()) {
      const auto hit = tree.first_hit(origin, d), expected = hit_by_trying_all(mesh, origin, d);
      ASSERT_EQ(hit.has_value(), expected.has_value());
      if (hit) {
        EXPECT_DOUBLE_EQ(hit->distance, expected->distance);
      }
    }
}

TEST(RayBvh, FindsTheWayOutOfAClosedSurfaceInEveryDirection) {
  const TriMesh mesh = icosphere(3);
  const RayBvh tree(mesh);
  // Through vertices and edges too: the vertices themselves are directions.
  for (const Vec3& d : mesh.vertices) {
    const auto hit = tree.first_hit(Vec3::Zero(), d.normalized());
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->distance, 1, 1e-9);
    EXPECT_TRUE(hit->from_behind);
    const auto back = tree.first_hit(3 * d, -d.normalized());
    ASSERT_TRUE(back);
    EXPECT_NEAR(back->distance, 2, 1e-9);
    EXPECT_FALSE(back->from_behind);
  }
}

TEST(RayBvh, KeepsToItsLimits) {
  const RayBvh tree(icosphere(2));
  EXPECT_FALSE(tree.first_hit(Vec3::Zero(), Vec3(0, 0, 1), 0, 0.5));
  EXPECT_FALSE(tree.first_hit(Vec3::Zero(), Vec3(0, 0, 1), 1.5));
  EXPECT_FALSE(tree.first_hit(Vec3(0, 0, 2), Vec3(0, 0, 1)));
  EXPECT_FALSE(RayBvh(TriMesh{}).first_hit(Vec3::Zero(), Vec3(0, 0, 1)));
}

TEST(RayBvh, RunsAlongTheFacesOfABox) {
  // Rays in the plane of a bounding box, in both signs of zero.
  const TriMesh cube = cube_surface(2);
  const RayBvh tree(cube);
  for (const double zero : {0.0, -0.0})
    for (const double edge : {-1.0, 1.0}) {
      const auto hit = tree.first_hit(Vec3(edge, 0.25, -3), Vec3(zero, zero, 1));
      ASSERT_TRUE(hit);
      EXPECT_DOUBLE_EQ(hit->distance, 2);
    }
}

}  // namespace
}  // namespace dynasurf::mesh
