#include "dynasurf/cloud/detail/free_sides.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/synthetic/detail/random.hpp"

namespace dynasurf::cloud {
namespace {

constexpr double cell = 0.05;

/// A ball, or a flat sheet, with the normals outwards or upwards.
OrientedPoints points_of(bool is_ball) {
  synthetic::Random random(3);
  OrientedPoints o;
  for (int n = 0; n < 20000; ++n) {
    const Vec3 way = Vec3(random.normal(), random.normal(), random.normal()).normalized();
    o.points.push_back(is_ball ? way : Vec3(2 * random.uniform() - 1, 2 * random.uniform() - 1, 0));
    o.normals.push_back(is_ball ? way : Vec3::UnitZ());
  }
  o.areas.assign(o.points.size(), 0.0006);
  return o;
}

TEST(FreeSides, AreOutsideOfABallAndOnBothSidesOfASheet) {
  OrientedPoints ball = points_of(true);
  const auto share = [](const std::vector<std::int8_t>& sides, int side) {
    return 1.0 * std::count(sides.begin(), sides.end(), side) / sides.size();
  };
  EXPECT_GT(share(free_sides(ball, cell), 1), 0.95) << "few rays slip between the points";
  EXPECT_EQ(share(free_sides(ball, cell), -1), 0);
  EXPECT_EQ(share(free_sides(points_of(false), cell), 0), 1);
  for (Vec3& n : ball.normals) n = -n;
  EXPECT_GT(share(free_sides(ball, cell), -1), 0.95);
}

TEST(FreeSides, TurnWhatRaysContradict) {
  OrientedPoints ball = points_of(true);
  EXPECT_FALSE(turned_to_free_sides(ball, cell)) << "nothing is against";
  for (std::size_t i = 0; i < ball.points.size(); ++i)
    if (ball.points[i].z() < 0.3) ball.normals[i] = -ball.normals[i];
  const auto turned = turned_to_free_sides(ball, cell);
  ASSERT_TRUE(turned);
  for (std::size_t i = 0; i < turned->points.size(); ++i)
    ASSERT_GT(turned->normals[i].dot(turned->points[i]), 0.99) << i;
  EXPECT_FALSE(turned_to_free_sides(points_of(false), cell)) << "a sheet has no side that is free alone";
  // Of this cap 52 % of the points have another one opposite.
  OrientedPoints cap;
  for (const Vec3& p : ball.points)
    if (p.z() > -0.35) {
      cap.points.push_back(p);
      cap.normals.push_back(-p);
    }
  EXPECT_FALSE(turned_to_free_sides(cap, cell)) << "too few tell";
}

/// Between z = -0.25 (0.5 - x) and 0.25 (0.5 - x), within a ball: its faces meet at 28 degrees.
PointCloud wing() {
  synthetic::Random random(7);
  const auto within = [](const Vec3& p) {
    return p.norm() < 1.3 && std::abs(p.x()) <= 0.5 && std::abs(p.z()) <= 0.25 * (0.5 - p.x()) + 1e-9;
  };
  PointCloud cloud;
  while (cloud.points.size() < 20000) {
    const double x = random.uniform() - 0.5, y = 2.6 * random.uniform() - 1.3, z = 0.25 * (0.5 - x);
    const double kind = random.uniform();  // by the areas of the boxes that places are drawn from
    Vec3 p(x, y, random.uniform() < 0.5 ? -z : z);
    if (kind < 0.19) p = Vec3(-0.5, y, 0.25 * (2 * random.uniform() - 1));
    if (kind > 0.9) {
      p.z() = 0.25 * (2 * random.uniform() - 1);
      p = 1.2999 * p.normalized();
    }
    if (within(p)) cloud.points.push_back(p);
  }
  return cloud;
}

// The two sides of the sharp edge look like one sheet to neighbours: the wing came out open, and "ok".
TEST(FreeSides, CloseABodyWithASharpEdge) {
  Options options;
  options.triangles = {5120};
  const Result result = reconstruct(wing(), options);
  EXPECT_EQ(result.facts.boundary, BoundaryRule::close);
  const Certificate& c = result.levels[0].certificate;
  EXPECT_TRUE(c.watertight());
  EXPECT_EQ(c.components, 1);
  EXPECT_EQ(c.genus, 0);
}

TEST(FreeSides, AreNotAskedWhereDirectionsAreGiven) {
  PointCloud up = wing();
  up.normals.assign(up.points.size(), Vec3::UnitZ());
  EXPECT_EQ(reconstruct(up, {}).facts.boundary, BoundaryRule::keep);
}

}  // namespace
}  // namespace dynasurf::cloud
