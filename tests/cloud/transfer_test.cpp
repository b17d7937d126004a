#include "dynasurf/cloud/detail/transfer.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/detail/sample_surface.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::cloud {
namespace {

/// Points on the unit sphere, red on the right, blue on the left.
PointCloud two_coloured(std::size_t count) {
  PointCloud cloud;
  const TriMesh fine = mesh::icosphere(5);
  for (const mesh::SurfaceSample& p : mesh::sample_surface(fine, count)) {
    cloud.points.push_back(mesh::position_of(fine, p).normalized());
    const bool right = cloud.points.back()[0] > 0;
    cloud.colours.push_back(
        {static_cast<std::uint8_t>(right ? 200 : 0), 30, static_cast<std::uint8_t>(right ? 0 : 90)});
  }
  return cloud;
}

auto colours_of(const TriMesh& mesh, const PointCloud& cloud) {
  return colours_at_vertices(mesh, cloud, KdTree(cloud.points));
}

TEST(ColoursAtVertices, AreThoseOfThePointsAround) {
  const TriMesh mesh = mesh::icosphere(3);
  const auto colours = colours_of(mesh, two_coloured(20000));
  ASSERT_EQ(colours.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < colours.size(); ++v) {
    EXPECT_EQ(colours[v][1], 30) << "one colour keeps its value through linear light and back";
    if (mesh.vertices[v][0] > 0.2) {
      EXPECT_EQ(colours[v][0], 200);
    }
    if (mesh.vertices[v][0] < -0.2) {
      EXPECT_EQ(colours[v][2], 90);
    }
  }
}

TEST(ColoursAtVertices, MixInLinearLight) {
  const TriMesh mesh = mesh::icosphere(0);
  PointCloud cloud;
  // Two points at every vertex, one black and one white: half the light is 188 in sRGB, not 128.
  for (const Vec3& p : mesh.vertices)
    for (const int byte : {0, 255}) {
      cloud.points.push_back(p);
      cloud.colours.push_back({static_cast<std::uint8_t>(byte), 0, 0});
    }
  for (const auto& colour : colours_of(mesh, cloud)) EXPECT_EQ(colour[0], 188);
}

TEST(ColoursAtVertices, AreAbsentWithoutColours) {
  PointCloud cloud = two_coloured(100);
  cloud.colours.clear();
  EXPECT_TRUE(colours_of(mesh::icosphere(1), cloud).empty());
  EXPECT_TRUE(colours_of({}, two_coloured(100)).empty());
}

TEST(ColoursAtVertices, GivesTheSameForAnyNumberOfThreads) {
  const TriMesh mesh = mesh::icosphere(4);
  const PointCloud cloud = two_coloured(30000);
  const auto colours = colours_of(mesh, cloud);
  const ThreadLimit one(1);
  EXPECT_EQ(colours_of(mesh, cloud), colours);
}

}  // namespace
}  // namespace dynasurf::cloud
