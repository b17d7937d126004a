#include "dynasurf/mesh/contour_stack.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"

namespace dynasurf::mesh {
namespace {

/// Circles of these radii, `gap` mm apart. Fine polygons: the 64 points of the mesh decide what is measured.
ContourStack circles(const std::vector<double>& radii, double gap) {
  ContourStack stack;
  for (std::size_t k = 0; k < radii.size(); ++k) {
    stack.contours.push_back(circle_contour({5, 5}, radii[k], radii[k] / 200));
    stack.z_mm.push_back(static_cast<double>(k) * gap);
  }
  return stack;
}

void expect_closed_sphere(const TriMesh& mesh) {
  const Topology t = topology(mesh);
  EXPECT_TRUE(t.closed());
  EXPECT_TRUE(t.oriented());
  EXPECT_EQ(t.euler, 2);
  EXPECT_EQ(t.components, 1);
}

TEST(Tessellate, ClosesEveryStackOfContours) {
  const ContourStack stack = circles({3, 8, 10, 9}, 4);
  for (const Strip strip : {Strip::even, Strip::greedy})
    for (const double dome : {0.0, 2.0}) {
      const TriMesh mesh = tessellate(stack, {.points = 64, .strip = strip}, {dome, 0});
      expect_closed_sphere(mesh);
      EXPECT_GT(volume_mm3(mesh), 0);
    }
  EXPECT_EQ(tessellate(stack, {}).triangles.size(), 3 * 2 * 64U + 2 * 64U);
}

TEST(Tessellate, FlipsNoTriangleBetweenNestedContours) {
  const TriMesh mesh = tessellate(circles({12, 7, 4}, 3), {});
  const Vec3 axis(5, 5, 0);
  for (std::size_t n = 64; n + 64 < mesh.triangles.size(); ++n) {
    const auto& t = mesh.triangles[n];
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Vec3 normal = (b - a).cross(c - a);
    EXPECT_GT(normal.head<2>().dot(((a + b + c) / 3 - axis).head<2>()), 0);
    EXPECT_GT(normal.z(), 0);
  }
}

TEST(Tessellate, GivesShortContoursFewerPointsWhenGreedy) {
  const TriMesh even = tessellate(circles({2, 10}, 3), {});
  const TriMesh greedy = tessellate(circles({2, 10}, 3), {.strip = Strip::greedy});
  EXPECT_EQ(even.vertices.size(), 2 * 64U + 2);
  EXPECT_EQ(greedy.vertices.size(), 64U + 13 + 2);  // 64 * 2 / 10 = 12.8
  EXPECT_GT(triangle_quality(greedy).shape_min, triangle_quality(even).shape_min);
}

TEST(StackVolumes, AgreeOnACylinder) {
  for (const Strip strip : {Strip::even, Strip::greedy}) {
    const StackVolumes v = volumes_of(circles({6, 6, 6, 6}, 2.5), {.strip = strip});
    const double area = 32 * 36 * std::sin(2 * std::numbers::pi / 64);  // of the polygon
    EXPECT_NEAR(v.gauss, area * 7.5, area * 7.5 * 2e-5);                // points sit on the fine polygon's edges
    EXPECT_NEAR(v.trapezoid, v.gauss, 1e-9 * v.gauss);
    EXPECT_NEAR(v.triangle_exact, v.gauss, 1e-9 * v.gauss);
  }
}

TEST(StackVolumes, ReadTheFrustumOfTheTrapezoidRuleTooLarge) {
  // A frustum from 10 to 6: t (A0 + A1) / 2 against t (A0 + sqrt(A0 A1) + A1) / 3 = 68 / 65.333.
  const StackVolumes v = volumes_of(circles({10, 6}, 5), {.points = 512});
  EXPECT_NEAR(v.trapezoid / v.gauss, 68 / (196 / 3.0), 1e-4);
  EXPECT_NEAR(v.triangle_exact, v.gauss, 1e-9 * v.gauss);
}

TEST(StackVolumes, KeepTheTrapezoidErrorOfAHemisphere) {
  // A = pi (R^2 - z^2) is a parabola: the trapezoid rule misses pi h^2 R / 6 of it.
  const double radius = 20, gap = 2;
  std::vector<double> radii;
  for (int k = 0; k < 10; ++k) radii.push_back(std::sqrt(radius * radius - gap * gap * k * k));
  const StackVolumes v = volumes_of(circles(radii, gap), {.points = 1024}, {0, gap});
  const double truth = 2 * std::numbers::pi * radius * radius * radius / 3;
  EXPECT_NEAR(v.trapezoid - truth, -std::numbers::pi * gap * gap * radius / 6, 0.03 * 42);
  EXPECT_LT(v.gauss, v.trapezoid);
  EXPECT_NEAR(v.triangle_exact, v.gauss, 1e-9 * v.gauss);
}

TEST(StackVolumes, EqualTheMeshTheyBelongTo) {
  const ContourStack stack = circles({4, 7, 5}, 3);
  const CapHeights caps{1.5, 1};
  EXPECT_DOUBLE_EQ(volumes_of(stack, {}, caps).gauss, volume_mm3(tessellate(stack, {}, caps)));
}

TEST(Tessellate, RefusesWhatIsNoStack) {
  ContourStack stack = circles({4, 7}, 3);
  std::swap(stack.z_mm[0], stack.z_mm[1]);
  EXPECT_THROW(tessellate(stack, {}), InputError);
  EXPECT_THROW(tessellate(circles({4}, 3), {}), InputError);
  EXPECT_THROW(tessellate(circles({4, 7}, 3), {.points = 2}), OptionError);
}

}  // namespace
}  // namespace dynasurf::mesh
