#include "dynasurf/cloud/transfer.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/sample_surface.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf {
namespace {

/// Points on the unit sphere, red on the right, blue on the left.
PointCloud two_coloured(std::size_t count) {
  PointCloud cloud;
  const TriMesh fine = icosphere(5);
  for (const SurfaceSample& p : sample_surface(fine, count)) {
    cloud.points.push_back(position_of(fine, p).normalized());
    const bool right = cloud.points.back()[0] > 0;
    cloud.colours.push_back(
        {static_cast<std::uint8_t>(right ? 200 : 0), 30, static_cast<std::uint8_t>(right ? 0 : 90)});
  }
  return cloud;
}

TEST(ColoursAtVertices, AreThoseOfThePointsAround) {
  const TriMesh mesh = icosphere(3);
  const auto colours = colours_at_vertices(mesh, two_coloured(20000));
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
  const TriMesh mesh = icosphere(0);
  PointCloud cloud;
  // Two points at every vertex, one black and one white: half the light is 188 in sRGB, not 128.
  for (const Vec3& p : mesh.vertices)
    for (const int byte : {0, 255}) {
      cloud.points.push_back(p);
      cloud.colours.push_back({static_cast<std::uint8_t>(byte), 0, 0});
    }
  for (const auto& colour : colours_at_vertices(mesh, cloud)) EXPECT_EQ(colour[0], 188);
}

TEST(ColoursAtVertices, AreAbsentWithoutColours) {
  PointCloud cloud = two_coloured(100);
  cloud.colours.clear();
  EXPECT_TRUE(colours_at_vertices(icosphere(1), cloud).empty());
  EXPECT_TRUE(colours_at_vertices({}, two_coloured(100)).empty());
}

TEST(ErrorsAtVertices, MeasureHowFarThePointsAre) {
  TriMesh mesh = icosphere(4);
  for (Vec3& p : mesh.vertices) p *= p[0] > 0 ? 1.0 : 0.9;
  const auto errors = errors_at_vertices(mesh, two_coloured(20000));
  for (std::size_t v = 0; v < errors.size(); ++v) {
    const Vec3 direction = mesh.vertices[v].normalized();
    // Edges of 0.07 leave a sagitta of 0.001.
    if (direction[0] > 0.2) {
      EXPECT_NEAR(errors[v], 0, 2e-3);
    }
    if (direction[0] < -0.2) {
      EXPECT_NEAR(errors[v], 0.1, 2e-3);
    }
  }
}

TEST(ErrorsAtVertices, SayNothingWhereThereIsNoPoint) {
  PointCloud half = two_coloured(5000), right;
  for (const Vec3& p : half.points)
    if (p[0] > 0) right.points.push_back(p);
  const TriMesh mesh = icosphere(3);
  const auto errors = errors_at_vertices(mesh, right);
  for (std::size_t v = 0; v < errors.size(); ++v) {
    if (mesh.vertices[v][0] < -0.3) {
      EXPECT_EQ(errors[v], -1);
    }
    if (mesh.vertices[v][0] > 0.3) {
      EXPECT_GE(errors[v], 0);
    }
  }
}

TEST(Transfer, GivesTheSameForAnyNumberOfThreads) {
  const TriMesh mesh = icosphere(4);
  const PointCloud cloud = two_coloured(30000);
  const auto colours = colours_at_vertices(mesh, cloud);
  const auto errors = errors_at_vertices(mesh, cloud);
  const ThreadLimit one(1);
  EXPECT_EQ(colours_at_vertices(mesh, cloud), colours);
  EXPECT_EQ(errors_at_vertices(mesh, cloud), errors);
}

}  // namespace
}  // namespace dynasurf
