#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/motion.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::mesh {
namespace {

TriMesh heart() {
  TriMesh mesh = icosphere(3);
  for (Vec3& p : mesh.vertices) p = p.cwiseProduct(Vec3(25, 25, 40));
  return mesh;
}

/// A systole: 19 degrees of twist between apex and base, 20 % shorter across, 10 % along.
Vec3 contracted(const Vec3& p) {
  const double angle = 19 * M_PI / 180 * (p[2] / 80);
  return {0.8 * (std::cos(angle) * p[0] - std::sin(angle) * p[1]),
          0.8 * (std::sin(angle) * p[0] + std::cos(angle) * p[1]), 0.9 * p[2]};
}

double twist(const TriMesh& rest, const TriMesh& now) {
  const auto at = [&](double low, double high) {
    return rotation_deg(rest.vertices, now.vertices, Vec3::Zero(), Vec3(0, 0, 1), low, high);
  };
  return (at(28, 36) - at(-36, -28)) * 80 / 64;  // heights 64 mm apart, of 80
}

TEST(SurfaceMotion, OfAGrowingSurfaceIsItsGrowth) {
  const TriMesh rest = heart();
  TriMesh now = rest;
  for (Vec3& p : now.vertices) p *= 1.1;
  const SurfaceMotion motion = surface_motion(rest, now);
  for (std::size_t v = 0; v < rest.vertices.size(); ++v) {
    EXPECT_NEAR(motion.displacement_mm[v], 0.1 * rest.vertices[v].norm(), 1e-9);
    EXPECT_NEAR(motion.area_strain_percent[v], 21, 1e-9);
    EXPECT_LT(motion.inward_mm[v], 0);
    EXPECT_LE(-motion.inward_mm[v], motion.displacement_mm[v] + 1e-12);
  }
  // A sphere's vertices move along its normals: all of the way is inwards.
  const TriMesh ball = icosphere(3);
  TriMesh smaller = ball;
  for (Vec3& p : smaller.vertices) p *= 0.9;
  for (const double inward : surface_motion(ball, smaller).inward_mm) EXPECT_NEAR(inward, 0.1, 1e-4);
  EXPECT_THROW(surface_motion(rest, icosphere(2)), InputError);
}

TEST(MoveWithPoints, RecoversTheTwistOfASystole) {
  // Tracked points as tags give them: some 60 within the wall, known to 0.3 mm. A surface alone shows no twist.
  const TriMesh rest = heart();
  std::vector<Vec3> points, moved;
  int n = 0;
  for (const Vec3& p : icosphere(1).vertices)
    for (const double depth : {1.02, 1.25}) {
      const Vec3 q = depth * p.cwiseProduct(Vec3(25, 25, 40));
      points.push_back(q);
      moved.push_back(contracted(q) + 0.3 * Vec3(std::sin(7.0 * n), std::cos(5.0 * n), std::sin(3.0 * n)));
      ++n;
    }
  const TriMesh now = move_with_points(rest, points, moved);
  EXPECT_NEAR(twist(rest, now), 19, 2);
  double farthest = 0;
  for (std::size_t v = 0; v < rest.vertices.size(); ++v)
    farthest = std::max(farthest, (now.vertices[v] - contracted(rest.vertices[v])).norm());
  EXPECT_LT(farthest, 1.5);
}

TEST(MoveWithPoints, TakesEveryPointToItsPlaceAndLinearMapsExactly) {
  const TriMesh rest = heart();
  Mat3 map;
  map << 0.9, 0.1, 0, -0.2, 0.8, 0.05, 0, 0.1, 1.1;
  std::vector<Vec3> points = icosphere(1).vertices, moved;
  for (Vec3& p : points) p *= 30;
  for (const Vec3& p : points) moved.push_back(map * p + Vec3(1, 2, 3));
  const TriMesh now = move_with_points(rest, points, moved);
  for (std::size_t v = 0; v < rest.vertices.size(); ++v)
    EXPECT_LT((now.vertices[v] - map * rest.vertices[v] - Vec3(1, 2, 3)).norm(), 1e-9);
  for (std::size_t n = 0; n < points.size(); ++n) moved[n] += Vec3(std::sin(n), std::cos(n), 0);
  const TriMesh tracked{points, {}};
  const TriMesh there = move_with_points(tracked, points, moved);
  for (std::size_t n = 0; n < points.size(); ++n) EXPECT_LT((there.vertices[n] - moved[n]).norm(), 1e-9);
}

TEST(MoveWithPoints, RefusesPointsThatSayTooLittle) {
  const std::vector<Vec3> plane{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}};
  EXPECT_THROW(move_with_points(heart(), plane, plane), InputError);
  EXPECT_THROW(move_with_points(heart(), std::vector<Vec3>(3), std::vector<Vec3>(3)), InputError);
  EXPECT_THROW(move_with_points(heart(), plane, std::vector<Vec3>(4)), InputError);
}

/// x of one vertex around a cycle of six gates.
double course(double phase, TimeInterpolation how) {
  std::vector<TriMesh> cycle;
  for (const double x : {0.0, 3.0, 4.0, 1.0, -2.0, -1.0})
    cycle.push_back({{{x, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
  return at_phase(cycle, phase, how).vertices[0][0];
}

/// Largest jump of the k-th difference quotient at the gates, against its size between them.
double jump(int order, TimeInterpolation how) {
  constexpr double h = 1e-3;
  double largest = 0;
  for (int g = 0; g < 6; ++g) {
    const double t = g / 6.0;
    const auto f = [&](double s) { return course(t + s, how); };
    const double left = order == 1 ? (f(0) - f(-h)) / h : (f(0) - 2 * f(-h) + f(-2 * h)) / (h * h);
    const double right = order == 1 ? (f(h) - f(0)) / h : (f(2 * h) - 2 * f(h) + f(0)) / (h * h);
    largest = std::max(largest, std::abs(right - left));
  }
  return largest;
}

TEST(TimeInterpolation, HasTheSmoothnessItsNameSays) {
  // Slopes are some 10 per beat, second derivatives some 100; the quotients themselves err by h times the next one.
  EXPECT_GT(jump(1, TimeInterpolation::linear), 5);
  for (const auto how :
       {TimeInterpolation::catmull_rom, TimeInterpolation::periodic_cubic, TimeInterpolation::b_spline})
    EXPECT_LT(jump(1, how), 1.5);
  EXPECT_GT(jump(2, TimeInterpolation::catmull_rom), 50);
  for (const auto how : {TimeInterpolation::periodic_cubic, TimeInterpolation::b_spline}) EXPECT_LT(jump(2, how), 15);
}

TEST(TimeInterpolation, PassesThroughTheGatesUnlessItSmooths) {
  for (const auto how : {TimeInterpolation::linear, TimeInterpolation::catmull_rom, TimeInterpolation::periodic_cubic})
    EXPECT_DOUBLE_EQ(course(2.0 / 6, how), 4);
  EXPECT_NEAR(course(2.0 / 6, TimeInterpolation::b_spline), (3 + 4 * 4 + 1) / 6.0, 1e-12);
  for (double phase = 0; phase < 1; phase += 0.013) {
    EXPECT_LE(course(phase, TimeInterpolation::b_spline), 4);
    EXPECT_GE(course(phase, TimeInterpolation::b_spline), -2);
  }
}

}  // namespace
}  // namespace dynasurf::mesh
