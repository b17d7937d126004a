#include "dynasurf/mesh/closest_point.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "support/shapes.hpp"

namespace dynasurf::mesh {
namespace {

using namespace test_shapes;

Vec3 place_of(const TriMesh& mesh, const SurfacePoint& s) {
  const auto& [a, b, c] = mesh.triangles[s.triangle];
  return s.weights[0] * mesh.vertices[a] + s.weights[1] * mesh.vertices[b] + s.weights[2] * mesh.vertices[c];
}

TEST(ClosestOnTriangle, KnowsFaceEdgesAndCorners) {
  const Vec3 a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  const SurfacePoint face = closest_on_triangle(Vec3(1, 1, 3), a, b, c);
  EXPECT_DOUBLE_EQ(face.distance2, 9);
  EXPECT_DOUBLE_EQ(face.weights[0], 0.5);
  const SurfacePoint edge = closest_on_triangle(Vec3(1, -2, 0), a, b, c);
  EXPECT_DOUBLE_EQ(edge.distance2, 4);
  EXPECT_DOUBLE_EQ(edge.weights[1], 0.25);
  const SurfacePoint slanted = closest_on_triangle(Vec3(4, 4, 0), a, b, c);
  EXPECT_DOUBLE_EQ(slanted.distance2, 8);
  const SurfacePoint corner = closest_on_triangle(Vec3(7, -4, 0), a, b, c);
  EXPECT_DOUBLE_EQ(corner.distance2, 25);
  EXPECT_DOUBLE_EQ(corner.weights[1], 1);
}

TEST(ClosestOnTriangle, TakesAFlatTriangleAsItsLongestEdge) {
  const SurfacePoint s = closest_on_triangle(Vec3(1, 2, 0), Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(1, 0, 0));
  EXPECT_DOUBLE_EQ(s.distance2, 4);
  const SurfacePoint point = closest_on_triangle(Vec3(0, 0, 2), Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
  EXPECT_DOUBLE_EQ(point.distance2, 4);
}

TEST(ClosestPoint, FindsWhatAskingEveryTriangleFinds) {
  const TriMesh mesh = torus(10, 3, 24, 12);
  const ClosestPoint closest(mesh);
  std::mt19937 random(3);
  const auto number = [&] { return 30 * (random() / 4294967296.0 - 0.5); };
  for (int n = 0; n < 300; ++n) {
    const Vec3 p(number(), number(), number());
    SurfacePoint best;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      const SurfacePoint s = closest_on_triangle(p, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], t);
      if (s.distance2 < best.distance2) best = s;
    }
    const SurfacePoint found = closest(p);
    EXPECT_DOUBLE_EQ(found.distance2, best.distance2);
    EXPECT_NEAR((place_of(mesh, found) - p).squaredNorm(), found.distance2, 1e-9);
  }
}

TEST(ClosestPoint, FindsNothingBeyondTheLimitOrOnAnEmptyMesh) {
  const TriMesh mesh = torus(10, 3, 24, 12);
  EXPECT_EQ(ClosestPoint(mesh)(Vec3::Zero(), 1.0).triangle, SurfacePoint::none);
  const TriMesh empty;
  EXPECT_EQ(ClosestPoint(empty)(Vec3::Zero()).triangle, SurfacePoint::none);
}

}  // namespace
}  // namespace dynasurf::mesh
