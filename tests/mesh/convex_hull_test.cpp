#include "dynasurf/mesh/detail/convex_hull.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/detail/predicates.hpp"
#include "dynasurf/mesh/intersections.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::mesh {
namespace {

/// The promises of the header, by exact predicates.
void expect_hull(const TriMesh& hull, const std::vector<Vec3>& points) {
  const Topology t = topology(hull);
  EXPECT_TRUE(t.closed() && t.oriented());
  EXPECT_EQ(t.euler, 2);
  EXPECT_GT(volume_mm3(hull), 0);
  EXPECT_TRUE(self_intersections(hull).free());
  std::size_t outside = 0;
  for (const auto& [a, b, c] : hull.triangles)
    for (const Vec3& p : points) outside += orient3d(hull.vertices[a], hull.vertices[b], hull.vertices[c], p) < 0;
  EXPECT_EQ(outside, 0u);
}

std::vector<Vec3> random_points(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);  // its numbers are the same everywhere
  std::vector<Vec3> points;
  const auto next = [&] { return static_cast<double>(random()) / 4294967296.0; };
  while (points.size() < count) points.emplace_back(next(), 3 * next(), 0.2 * next());
  return points;
}

TEST(ConvexHull, HoldsEveryPointOfARandomCloud) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const std::vector<Vec3> points = random_points(400, seed);
    expect_hull(convex_hull(points), points);
  }
}

TEST(ConvexHull, OfASphereHasAllItsVertices) {
  const TriMesh sphere = icosphere(3);
  const TriMesh hull = convex_hull(sphere.vertices);
  expect_hull(hull, sphere.vertices);
  EXPECT_EQ(hull.vertices.size(), sphere.vertices.size());
  EXPECT_GE(volume_mm3(hull), volume_mm3(sphere) * (1 - 1e-12));
}

TEST(ConvexHull, OfALatticeFullOfPlanesAndLinesIsItsCube) {
  std::vector<Vec3> lattice;
  for (int i = 0; i < 1000; ++i) lattice.emplace_back(i % 10, i / 10 % 10, i / 100);
  const TriMesh hull = convex_hull(lattice);
  expect_hull(hull, lattice);
  EXPECT_EQ(volume_mm3(hull), 729);
}

TEST(ConvexHull, KeepsItsWordWhereRoundedNumbersCannotTell) {
  // Points on the faces of a tilted cube, up to rounding: which lie outside is decided by their last bits.
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Vec3> points;
  for (int n = 0; n < 600; ++n) {
    Vec3 p(n % 11 / 10.0, n / 11 % 11 / 10.0, n % 7 / 6.0);
    p[n % 3] = n % 2;
    points.push_back(turn * p + Vec3(1000, -2000, 3000));
  }
  expect_hull(convex_hull(points), points);
}

TEST(ConvexHull, CountsRepeatedPointsOnce) {
  std::vector<Vec3> points = random_points(60, 5);
  points.insert(points.end(), points.begin(), points.begin() + 60);
  const TriMesh hull = convex_hull(points);
  expect_hull(hull, points);
  EXPECT_EQ(hull.vertices, convex_hull(std::span(points).first(60)).vertices);
}

TEST(ConvexHull, RefusesPointsWithoutAVolume) {
  const auto hull = [](std::vector<Vec3> points) { return convex_hull(points); };
  EXPECT_THROW(hull({}), InputError);
  EXPECT_THROW(hull(std::vector<Vec3>(9, Vec3(1, 2, 3))), InputError);
  EXPECT_THROW(hull({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}), InputError);
  EXPECT_THROW(hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.3, 0.7, 0}}), InputError);
  EXPECT_THROW(hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, std::numeric_limits<double>::infinity()}}), InputError);
}

TEST(EvenHull, HasTheTrianglesAskedForOnTheHullItself) {
  std::vector<Vec3> corners;
  for (int n = 0; n < 8; ++n) corners.emplace_back(n & 1, n >> 1 & 1, 2 * (n >> 2 & 1));
  for (const std::size_t triangles : {80u, 1280u}) {
    const TriMesh hull = even_hull(corners, triangles);
    EXPECT_EQ(hull.triangles.size(), triangles);
    EXPECT_EQ(topology(hull).euler, 2);
    EXPECT_NEAR(volume_mm3(hull), 2, 0.02) << "the corners and edges of the box stay";
    double longest = 0;
    for (const auto& t : hull.triangles)
      longest = std::max(longest, (hull.vertices[t[0]] - hull.vertices[t[1]]).norm());
    // Equilateral triangles would have edges of sqrt(4 area / (sqrt(3) n)).
    EXPECT_LT(longest, 2.5 * std::sqrt(4 * 10 / (std::numbers::sqrt3 * static_cast<double>(triangles))));
  }
}

}  // namespace
}  // namespace dynasurf::mesh
