#include "dynasurf/mesh/detail/sample_surface.hpp"

#include <gtest/gtest.h>

#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::mesh {
namespace {

TEST(SampleSurface, GivesEachTriangleItsShareOfTheArea) {
  TriMesh mesh = icosphere(2);
  for (Vec3& p : mesh.vertices) p = Vec3(p[0], 5 * p[1], 0.2 * p[2]);  // triangles of very different area
  const std::size_t count = 10000;
  const auto points = sample_surface(mesh, count);
  ASSERT_EQ(points.size(), count);
  std::vector<double> hits(mesh.triangles.size(), 0);
  for (const SurfaceSample& p : points) hits[p.triangle] += 1;
  const double whole = area_mm2(mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const double share = area_mm2({mesh.vertices, {mesh.triangles[t]}}) / whole;
    EXPECT_NEAR(hits[t], share * count, 1) << "up to one point";
  }
}

TEST(SampleSurface, SpreadsPointsEvenlyWithinATriangle) {
  const TriMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  Vec3 sum(0, 0, 0);
  std::size_t near_corner = 0;
  const std::size_t count = 4000;
  for (const SurfaceSample& p : sample_surface(mesh, count)) {
    EXPECT_GE(p.weight.minCoeff(), 0);
    EXPECT_NEAR(p.weight.sum(), 1, 1e-12);
    sum += position_of(mesh, p);
    near_corner += p.weight[0] > 0.75;
  }
  EXPECT_NEAR(sum[0] / count, 1.0 / 3, 1e-3);
  EXPECT_NEAR(sum[1] / count, 1.0 / 3, 1e-3);
  EXPECT_NEAR(static_cast<double>(near_corner) / count, 1.0 / 16, 2e-3) << "a sixteenth of the area";
}

TEST(SampleSurface, GivesNothingForASurfaceWithoutArea) {
  EXPECT_TRUE(sample_surface({}, 10).empty());
  EXPECT_TRUE(sample_surface({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}}, 10).empty());
  EXPECT_TRUE(sample_surface(icosphere(0), 0).empty());
}

}  // namespace
}  // namespace dynasurf::mesh
