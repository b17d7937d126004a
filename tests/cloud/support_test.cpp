#include "dynasurf/cloud/detail/support.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "dynasurf/cloud/detail/outliers.hpp"
#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"
#include "dynasurf/synthetic/detail/random.hpp"

namespace dynasurf::cloud {
namespace {

Result reconstructed(const PointCloud& cloud, BoundaryRule boundary = BoundaryRule::automatic) {
  Options options;
  options.triangles = {1280};
  options.boundary = boundary;
  return reconstruct(cloud, options);
}

bool warns(const Result& result, const std::string& code) {
  return std::any_of(result.notes.begin(), result.notes.end(),
                     [&](const Note& n) { return n.code == code && n.severity == Severity::warning; });
}

/// A share of points anywhere in the box of the others.
PointCloud with_stray_points(PointCloud cloud, double share) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : cloud.points) box.extend(p);
  synthetic::Random random(5);
  const auto count = static_cast<std::size_t>(share * static_cast<double>(cloud.points.size()));
  for (std::size_t n = 0; n < count; ++n) {
    Vec3 p;
    for (int a = 0; a < 3; ++a) p[a] = box.min()[a] + random.uniform() * box.sizes()[a];
    cloud.points.push_back(p);
  }
  return cloud;
}

// A lattice of step 1, whose points stand for squares of side 1: surface is supported within 3.
TEST(Support, ConfidenceFallsAsTheDistanceGrowsBeyondWhatPointsSupport) {
  std::vector<Vec3> points;
  for (int i = 0; i < 30; ++i)
    for (int j = 0; j < 30; ++j) points.emplace_back(i, j, 0);
  Facts facts;
  facts.spacing = 1;
  TriMesh mesh{{Vec3(15, 15, 2.9), Vec3(15, 15, -12), Vec3(15, 15, 24)}, {{0, 1, 2}}};
  const KdTree tree(points);
  const std::vector<float> confidence = confidences(mesh, {points, tree, facts});
  ASSERT_EQ(confidence.size(), 3u);
  EXPECT_EQ(confidence[0], 1);
  // The circle around 12 neighbours of a lattice has radius 2: squares of side 1.02.
  EXPECT_NEAR(confidence[1], 3.0 / 12, 0.01);
  EXPECT_NEAR(confidence[2], 3.0 / 24, 0.01);
}

TEST(Support, AWholeScanIsOk) {
  for (const synthetic::CloudShape shape : {synthetic::CloudShape::sphere, synthetic::CloudShape::torus,
                                            synthetic::CloudShape::two_torus, synthetic::CloudShape::blobs}) {
    const Result result = reconstructed(synthetic::make_cloud({.shape = shape, .points = 20000}));
    EXPECT_EQ(verdict_of(result), Verdict::ok) << static_cast<int>(shape);
    EXPECT_EQ(result.support.made_up, 0) << static_cast<int>(shape);
    EXPECT_EQ(*std::min_element(result.levels[0].confidence.begin(), result.levels[0].confidence.end()), 1);
  }
}

TEST(Support, AHalfScannedBodyIsMadeUpAndTold) {
  PointCloud cloud = synthetic::make_cloud({.points = 20000});
  std::erase_if(cloud.points, [](const Vec3& p) { return p.z() < 0; });
  const Result result = reconstructed(cloud, BoundaryRule::close);
  EXPECT_EQ(verdict_of(result), Verdict::check);
  EXPECT_TRUE(warns(result, "cloud.holes"));
  EXPECT_NEAR(result.support.made_up, 0.5, 0.1);
  EXPECT_EQ(reconstructed(cloud).support.made_up, 0);
  const Level& level = result.levels[0];
  for (std::size_t v = 0; v < level.mesh.vertices.size(); ++v) {
    const double z = level.mesh.vertices[v].z();
    if (z > 0.05) {
      EXPECT_EQ(level.confidence[v], 1) << z;
    }
    if (z < -0.3) {
      EXPECT_LT(level.confidence[v], 0.5) << z;
    }
  }
}

TEST(Support, AnOpenSheetIsOkAsSuchOnly) {
  PointCloud terrain;
  synthetic::Random random(3);
  for (int n = 0; n < 20000; ++n) {
    const double x = 2 * random.uniform() - 1, y = 2 * random.uniform() - 1;
    terrain.points.emplace_back(x, y, 0.12 * std::sin(4 * x) * std::cos(3 * y) + 0.05 * std::sin(9 * x + 4 * y));
  }
  EXPECT_NE(verdict_of(reconstructed(terrain, BoundaryRule::close)), Verdict::ok);
  EXPECT_EQ(verdict_of(reconstructed(terrain)), Verdict::ok);
}

// One of two balls that touch was lost, and every level watertight.
TEST(Support, TwoBallsThatTouchAreBothThereOrTold) {
  PointCloud cloud = synthetic::make_cloud({.points = 10000}), other = cloud;
  for (Vec3& p : other.points) cloud.points.push_back(p + Vec3(2.002, 0, 0));
  const Result result = reconstructed(cloud);
  const Certificate& c = result.levels[0].certificate;
  const bool both = c.components == 2 && std::abs(c.volume / (8.0 / 3 * 3.14159265) - 1) < 0.03;
  EXPECT_TRUE(both || verdict_of(result) != Verdict::ok);
}

// The points stand for squares with sides of 2.8 % of the edges of the cubes, and the gap is 3 % wide.
TEST(Support, AGapAsNarrowAsThePointsIsTold) {
  PointCloud cloud = synthetic::make_cloud({.shape = synthetic::CloudShape::cube, .points = 8000}), other = cloud;
  Eigen::AlignedBox3d box;
  for (const Vec3& p : cloud.points) box.extend(p);
  for (Vec3& p : other.points) cloud.points.push_back(p + 1.03 * box.sizes()[0] * Vec3::UnitX());
  const Result result = reconstructed(cloud);
  EXPECT_GT(result.support.gaps, 0.02);
  EXPECT_TRUE(warns(result, "cloud.gaps"));
  EXPECT_EQ(reconstructed(synthetic::make_cloud({.points = 4000})).support.gaps, 0);
}

// Both sides of a plate that is thinner than its points lie apart are told by their directions.
TEST(Support, AThinPlateIsOk) {
  const Result result = reconstructed(synthetic::make_cloud({.shape = synthetic::CloudShape::plate, .points = 4000}));
  EXPECT_GT(result.support.thin, 0.5);
  EXPECT_LT(result.support.gaps, 0.01);
  EXPECT_EQ(verdict_of(result), Verdict::ok);
  const auto is_told = [](const Note& n) { return n.code == "cloud.thin" && n.severity == Severity::info; };
  EXPECT_TRUE(std::any_of(result.notes.begin(), result.notes.end(), is_told));
}

TEST(Support, AThinSheetThatCameOutOpenIsTold) {
  CloudSupport support;
  support.thin = 0.03;
  ASSERT_EQ(doubts_of(support, true).size(), 1u);
  EXPECT_EQ(doubts_of(support, true)[0].severity, Severity::warning);
  EXPECT_EQ(doubts_of(support, false)[0].severity, Severity::info);
  support.gaps = 0.03;
  ASSERT_EQ(doubts_of(support, false).size(), 1u);
  EXPECT_EQ(doubts_of(support, false)[0].code, "cloud.gaps");
  EXPECT_EQ(doubts_of(support, false)[0].severity, Severity::warning);
}

/// The unit sphere, with points up to `longest` off it: along a thorn, or anywhere.
PointCloud sphere_with(std::size_t count, double longest, bool is_thorn) {
  PointCloud cloud = synthetic::make_cloud({.points = 20000});
  const double radius = cloud.points[0].norm();
  synthetic::Random random(3);
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3 way = is_thorn ? Vec3::UnitX() : Vec3(random.normal(), random.normal(), random.normal()).normalized();
    const Vec3 aside = 0.004 * Vec3(0, random.normal(), random.normal());
    cloud.points.push_back(radius * ((1.1 + (longest - 0.1) * random.uniform()) * way + aside));
  }
  return cloud;
}

TEST(Support, PointsThatStandAloneAreNotLeftOutButAThornIs) {
  Options options;
  options.triangles = {1280};
  options.outliers = 0;  // they would be dropped
  for (const double longest : {0.15, 0.5}) {
    EXPECT_FALSE(warns(reconstruct(sphere_with(40, longest, false), options), "cloud.left_out")) << longest;
    EXPECT_TRUE(warns(reconstruct(sphere_with(40, longest, true), options), "cloud.left_out")) << longest;
  }
}

// In the flat box of a ring stray points look much like a surface, but there are few of them.
TEST(Support, StrayPointsBesideAFlatBodyAreNotLeftOut) {
  PointCloud ring;
  synthetic::Random random(3);
  while (ring.points.size() < 20000) {
    const double around = 2 * std::numbers::pi * random.uniform(), across = 2 * std::numbers::pi * random.uniform();
    if (random.uniform() > (1 + 0.05 * std::cos(across)) / 1.05) continue;
    const double r = 1 + 0.05 * std::cos(across);
    ring.points.emplace_back(r * std::cos(around), r * std::sin(around), 0.05 * std::sin(across));
  }
  const Result result = reconstructed(with_stray_points(ring, 0.01));
  EXPECT_EQ(verdict_of(result), Verdict::ok);
  EXPECT_EQ(result.levels[0].certificate.genus, 1);
  Options options;
  options.triangles = {1280};
  options.outliers = 0;
  EXPECT_TRUE(warns(reconstruct(with_stray_points(ring, 0.02), options), "cloud.left_out"));
}

TEST(Outliers, StrayPointsInTheBoxAreDropped) {
  for (const synthetic::CloudShape shape :
       {synthetic::CloudShape::sphere, synthetic::CloudShape::two_torus, synthetic::CloudShape::spring}) {
    const PointCloud clean = synthetic::make_cloud({.shape = shape, .points = 20000}),
                     cloud = with_stray_points(clean, 0.01);
    const std::vector<std::uint8_t> kept = parts_of_surfaces(cloud.points, KdTree(cloud.points), 6);
    // Those near the surface cannot be told from it.
    const KdTree surface(clean.points);
    std::size_t lost = 0, far = 0, left = 0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      if (i < clean.points.size()) lost += !kept[i];
      if (std::sqrt(surface.nearest(cloud.points[i]).distance2) < 0.1) continue;
      ++far;
      left += kept[i];
    }
    EXPECT_GT(far, 50u);
    EXPECT_EQ(left, 0u) << static_cast<int>(shape);
    EXPECT_LT(lost, 20u) << static_cast<int>(shape);
  }
}

TEST(Outliers, StrayPointsTurnNothingInsideOut) {
  for (const synthetic::CloudShape shape :
       {synthetic::CloudShape::two_torus, synthetic::CloudShape::spring, synthetic::CloudShape::vase}) {
    const Result result =
        reconstructed(with_stray_points(synthetic::make_cloud({.shape = shape, .points = 20000}), 0.01));
    const Certificate& c = result.levels[0].certificate;
    EXPECT_TRUE(c.watertight()) << static_cast<int>(shape);
    EXPECT_EQ(c.components, 1) << static_cast<int>(shape);
    EXPECT_EQ(c.genus, synthetic::genus_of(shape)) << static_cast<int>(shape);
  }
}

TEST(Orientation, GivenDirectionsThatPointInwardsAreTurned) {
  PointCloud cloud = synthetic::make_cloud({.shape = synthetic::CloudShape::blobs, .points = 20000, .normals = true});
  const double volume = reconstructed(cloud).levels[0].certificate.volume;
  for (Vec3& n : cloud.normals) n = -n;
  const Result result = reconstructed(cloud);
  EXPECT_TRUE(result.levels[0].certificate.watertight());
  EXPECT_NEAR(result.levels[0].certificate.volume / volume, 1, 1e-6);
}

// 400 times fewer points on one half than on the other, where nothing is an outlier.
TEST(Outliers, ThinlyScannedSurfaceStays) {
  PointCloud cloud = synthetic::make_cloud({.points = 100000}), thin;
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (cloud.points[i].x() > 0 || i % 400 == 0) thin.points.push_back(cloud.points[i]);
  const std::vector<std::uint8_t> kept = parts_of_surfaces(thin.points, KdTree(thin.points), 6);
  // Some 125 points see that half. Those at its rim have neighbours of the other alone, and a few of them go.
  EXPECT_LT(std::count(kept.begin(), kept.end(), 0), 40);
}

}  // namespace
}  // namespace dynasurf::cloud
