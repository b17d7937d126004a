#include "dynasurf/synthetic/cloud_shapes.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/repair.hpp"

namespace dynasurf::synthetic {
namespace {

class EveryCloudShape : public testing::TestWithParam<int> {
 protected:
  CloudShape shape = static_cast<CloudShape>(GetParam());
};

TEST_P(EveryCloudShape, IsAValidSurfaceWithItsHandles) {
  const TriMesh mesh = cloud_reference(shape);
  EXPECT_TRUE(mesh::check_surface(mesh).valid());
  const mesh::Topology t = mesh::topology(mesh);
  EXPECT_EQ(t.components, 1);
  EXPECT_EQ(t.euler, 2 - 2 * genus_of(shape));
  EXPECT_GT(mesh::volume_mm3(mesh), 0);
  EXPECT_GT(mesh.triangles.size(), 10000u);
  EXPECT_LT(mesh.triangles.size(), 200000u);
}

INSTANTIATE_TEST_SUITE_P(Shapes, EveryCloudShape, testing::Range(0, static_cast<int>(names_of(CloudShape{}).size())),
                         [](const auto& one) { return std::string(word_of(static_cast<CloudShape>(one.param))); });

TEST(CloudPhantom, CleanPointsLieOnTheirSphereWithItsNormals) {
  const PointCloud cloud = make_cloud({.points = 2000, .normals = true});
  ASSERT_EQ(cloud.points.size(), 2000u);
  ASSERT_EQ(cloud.normals.size(), 2000u);
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = 0; i < 2000; ++i) {
    // The reference has edges of 0.02: its faces lie up to 0.0001 inside the sphere.
    EXPECT_NEAR(cloud.points[i].norm(), 1, 2e-4);
    EXPECT_GT(cloud.points[i].dot(cloud.normals[i]), 0.999);
    mean += cloud.points[i] / 2000;
  }
  // Even by area: the mean of 2000 points has a standard deviation of 1/sqrt(3 * 2000) along each axis.
  EXPECT_LT(mean.norm(), 4 * 0.013 * std::sqrt(3.0));
}

TEST(CloudPhantom, NoiseHasItsStandardDeviation) {
  const PointCloud cloud = make_cloud({.points = 20000, .noise_percent = 0.5});
  double squares = 0;
  for (const Vec3& p : cloud.points) squares += (p.norm() - 1) * (p.norm() - 1) / 20000;
  // 0.5 % of the diagonal of a cube of side 2; 20000 squares have a relative standard deviation of 1 %.
  EXPECT_NEAR(std::sqrt(squares), 0.005 * 2 * std::sqrt(3.0), 0.02 * 0.0173);
}

TEST(CloudPhantom, TheHoleIsOneCapOfTheSphere) {
  const PointCloud whole = make_cloud({.points = 5000}), torn = make_cloud({.points = 5000, .missing_percent = 20});
  ASSERT_EQ(torn.points.size(), 4000u);
  Vec3 missing = Vec3::Zero(), left = Vec3::Zero();
  for (const Vec3& p : whole.points) missing += p;
  for (const Vec3& p : torn.points) left += p;
  const Vec3 axis = (missing - left).normalized();
  // A cap of a fifth of a sphere begins at a height of 0.6.
  for (const Vec3& p : torn.points) EXPECT_LT(p.dot(axis), 0.65);
}

TEST(CloudPhantom, TheSameSeedGivesTheSamePoints) {
  const CloudPhantom o{.shape = CloudShape::blobs, .points = 500, .noise_percent = 1};
  CloudPhantom other = o;
  other.seed = 2;
  EXPECT_EQ(make_cloud(o).points, make_cloud(o).points);
  EXPECT_NE(make_cloud(o).points, make_cloud(other).points);
}

TEST(CloudPhantom, HasTheThesissCountOfPointsOfItsSixBodies) {
  const std::pair<CloudShape, std::size_t> published[] = {{CloudShape::rabbit, 67038}, {CloudShape::screwdriver, 27152},
                                                          {CloudShape::vase, 68097},   {CloudShape::venus, 134345},
                                                          {CloudShape::moai, 10002},   {CloudShape::squirrel, 9996}};
  for (const auto& [shape, count] : published) {
    EXPECT_EQ(make_cloud({.shape = shape, .points = 0}).points.size(), count) << word_of(shape);
    EXPECT_EQ(genus_of(shape), 0) << word_of(shape);
  }
  EXPECT_EQ(make_cloud({.points = 0}).points.size(), 100000u);
}

/// How many separate curves a horizontal plane cuts out of a body.
std::size_t curves_at(CloudShape shape, double z) {
  return mesh::cross_section(cloud_reference(shape), Vec3(0, 0, z), Vec3(0, 0, 1)).size();
}

TEST(CloudPhantom, ShowsTheFeaturesOfTheThesissBodies) {
  EXPECT_EQ(curves_at(CloudShape::rabbit, 0.9), 2u) << "two ears";
  EXPECT_EQ(curves_at(CloudShape::squirrel, 0.95), 1u) << "the tip of the tail above the ears";
  EXPECT_EQ(curves_at(CloudShape::squirrel, 0.1), 2u) << "the tail beside the back";
  EXPECT_EQ(curves_at(CloudShape::moai, 0.0), 1u);
  EXPECT_EQ(curves_at(CloudShape::venus, 0.0), 1u) << "the neck";
  // Eight flutes: the section of the handle turns in between them.
  const auto handle = mesh::cross_section(cloud_reference(CloudShape::screwdriver), Vec3(-0.75, 0, 0), Vec3(1, 0, 0));
  ASSERT_EQ(handle.size(), 1u);
  int crests = 0;
  const auto radius = [&](std::size_t n) {
    const Vec3& p = handle[0][n % (handle[0].size() - 1)];
    return std::hypot(p[1], p[2]);
  };
  bool is_high = radius(0) > 0.2;
  for (std::size_t n = 1; n < handle[0].size(); ++n) {
    if (!is_high && radius(n) > 0.212) is_high = true, ++crests;
    if (is_high && radius(n) < 0.188) is_high = false;
  }
  EXPECT_NEAR(crests, 8, 1);
}

TEST(CloudPhantom, RefusesOptionsOutOfRange) {
  EXPECT_THROW(make_cloud({.points = 5}), OptionError);
  EXPECT_THROW(make_cloud({.missing_percent = 95}), OptionError);
  EXPECT_THROW(scan_surface({}, {}), InputError);
}

}  // namespace
}  // namespace dynasurf::synthetic
