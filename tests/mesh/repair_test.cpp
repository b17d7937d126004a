#include "dynasurf/mesh/repair.hpp"

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/intersections.hpp"
#include "dynasurf/mesh/measures.hpp"

#include "support/shapes.hpp"

namespace dynasurf::mesh {
namespace {

using namespace test_shapes;

TriMesh ball(double radius_mm) {
  return mapped(icosphere(3), [&](const Vec3& p) { return Vec3(radius_mm * p); });
}

/// A ball whose vertices have wandered within its surface: triangles of any shape, none folded over far.
TriMesh shuffled_ball(double amplitude) {
  std::mt19937 random(5);
  const auto number = [&] { return random() / 2147483648.0 - 1; };
  return mapped(icosphere(3), [&](const Vec3& p) {
    const double z = number(), y = number(), x = number();  // in this order, whatever the compiler
    return Vec3(30 * (p + amplitude * Vec3(x, y, z)).normalized());
  });
}

TEST(CheckSurface, AcceptsBallsAndTori) {
  EXPECT_TRUE(check_surface(ball(30)).valid());
  EXPECT_TRUE(check_surface(torus(10, 3, 20, 10)).valid());
}

TEST(CheckSurface, TellsWhatIsWrong) {
  TriMesh open = ball(30);
  open.triangles.pop_back();
  EXPECT_FALSE(check_surface(open).closed);
  EXPECT_TRUE(check_surface(open).manifold);

  TriMesh turned = ball(30);
  std::swap(turned.triangles[7][1], turned.triangles[7][2]);
  EXPECT_FALSE(check_surface(turned).oriented);
  EXPECT_TRUE(check_surface(turned).closed);

  TriMesh fin = ball(30);
  fin.triangles.push_back({fin.triangles[0][0], fin.triangles[0][1], 400});
  EXPECT_FALSE(check_surface(fin).manifold);

  TriMesh folded = ball(30);
  folded.vertices[0] *= -1.5;
  EXPECT_GT(check_surface(folded).self_intersections, 0u);

  EXPECT_FALSE(check_surface({}).closed);
}

TEST(CheckSurface, TwoTetrahedraOnOneVertexAreNotManifold) {
  TriMesh two = tetrahedron();
  for (const Vec3& p : {Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1)}) two.vertices.push_back(p);
  for (const auto& t : tetrahedron().triangles) {
    auto corner = [&](std::uint32_t v) { return v == 0 ? 0 : v + 3; };
    two.triangles.push_back({corner(t[0]), corner(t[2]), corner(t[1])});
  }
  const SurfaceCheck check = check_surface(two);
  EXPECT_TRUE(check.closed && check.oriented);
  EXPECT_FALSE(check.manifold);
  EXPECT_EQ(check.self_intersections, 0u);
}

TEST(Tidy, ImprovesTheWorstTriangleAndKeepsTheVolume) {
  TriMesh mesh = shuffled_ball(0.07);
  const double shape = triangle_quality(mesh).shape_min, volume = volume_mm3(mesh);
  ASSERT_LT(shape, 0.1);
  const MoveReport report = tidy(mesh, {});
  EXPECT_GT(triangle_quality(mesh).shape_min, 0.3 * (1 - 1e-9));
  EXPECT_NEAR(volume_mm3(mesh), volume, 1e-9 * volume);  // rounding: moves are across the volume's gradient
  EXPECT_NEAR(report.volume_change_mm3, 0, 1e-9 * volume);
  EXPECT_GT(report.vertices_moved, 0u);
  // The surface stays: within the sagitta of its own triangles.
  for (const Vec3& p : mesh.vertices) EXPECT_NEAR(p.norm(), 30, 0.3);
}

TEST(Tidy, LeavesGoodTrianglesAlone) {
  TriMesh mesh = ball(30);
  const auto before = mesh.vertices;
  EXPECT_EQ(tidy(mesh, {}).vertices_moved, 0u);
  EXPECT_EQ(mesh.vertices, before);
}

TEST(Tidy, PartsVerticesThatFellTogether) {
  TriMesh mesh = ball(30);
  const std::uint32_t a = mesh.triangles[100][0], b = mesh.triangles[100][1];
  mesh.vertices[a] = mesh.vertices[b];
  ASSERT_EQ(triangle_quality(mesh).shape_min, 0);
  tidy(mesh, {});
  EXPECT_GT(triangle_quality(mesh).shape_min, 0.3);
}

TEST(Tidy, KeepsTheRimOfAnOpenSheetAndRefusesWrongOptions) {
  TriMesh mesh = sheet(4);
  mesh.vertices[12] += Vec3(0.9, 0.8, 0);
  const TriMesh before = mesh;
  tidy(mesh, {});
  EXPECT_NE(mesh.vertices[12], before.vertices[12]);
  for (const std::uint32_t v : {0u, 1u, 4u, 24u, 20u}) EXPECT_EQ(mesh.vertices[v], before.vertices[v]);
  Tidy wrong;
  wrong.shape = 2;
  EXPECT_THROW(tidy(mesh, wrong), OptionError);
}

TEST(Untangle, LeavesASurfaceWithoutIntersectionsByteForByte) {
  TriMesh mesh = shuffled_ball(0.03);
  const auto before = mesh.vertices;
  ASSERT_TRUE(self_intersections(mesh).free());
  const UntangleReport report = untangle(mesh, 40);
  EXPECT_EQ(report.found, 0u);
  EXPECT_EQ(report.vertices_moved, 0u);
  EXPECT_EQ(mesh.vertices, before);
}

TEST(Untangle, FreesWhatWasPushedThroughItself) {
  // A vertex through the far side; a dent deeper than the ball; a ball scrambled so that many triangles fold.
  TriMesh needle = ball(30);
  needle.vertices[0] *= -1.5;
  TriMesh dent = mapped(ball(30), [](const Vec3& p) { return p[2] > 22 ? Vec3(p[0], p[1], p[2] - 60) : p; });
  TriMesh scrambled = shuffled_ball(0.2);
  for (TriMesh* mesh : {&needle, &dent, &scrambled}) {
    const TriMesh before = *mesh;
    const UntangleReport report = untangle(*mesh, 40);
    EXPECT_GT(report.found, 0u);
    EXPECT_EQ(report.left, 0u);
    EXPECT_TRUE(check_surface(*mesh).valid());
    EXPECT_NEAR(report.volume_change_mm3, volume_mm3(*mesh) - volume_mm3(before), 1e-9);
  }
}

TEST(Untangle, MovesOnlyTheNeighbourhood) {
  TriMesh mesh = ball(30);
  const std::uint32_t v = mesh.triangles[50][0];
  const std::uint32_t w = mesh.triangles[50][1];
  mesh.vertices[v] += 2.5 * (mesh.vertices[w] - mesh.vertices[v]);  // over its neighbour and beyond
  const TriMesh before = mesh;
  ASSERT_FALSE(self_intersections(mesh).free());
  const UntangleReport report = untangle(mesh, 40);
  EXPECT_EQ(report.left, 0u);
  EXPECT_LT(report.vertices_moved, 60u);  // of 642
  for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
    if (before.vertices[n].dot(before.vertices[w]) < 0) {
      EXPECT_EQ(mesh.vertices[n], before.vertices[n]);
    }
  }
}

TEST(Untangle, GivesTheSurfaceBackAsItWasWhenTheRoundsDoNotSuffice) {
  // A long and a flat ball around one centre cut each other however small they shrink.
  TriMesh both = ellipsoid(1, {1, 1, 3});
  for (const Vec3& p : ellipsoid(1, {2, 2, 1}).vertices) both.vertices.push_back(p + Vec3(0.01, 0.02, 0.03));
  for (const auto& t : icosphere(1).triangles) both.triangles.push_back({t[0] + 42, t[1] + 42, t[2] + 42});
  const auto before = both.vertices;
  const UntangleReport report = untangle(both, 2);
  EXPECT_GT(report.found, 0u);
  EXPECT_EQ(report.left, report.found);
  EXPECT_EQ(both.vertices, before);
  EXPECT_EQ(untangle(both, 0).left, report.found);
}

TEST(RepairSurface, TidiesUntanglesAndSaysWhatIsLeft) {
  TriMesh good = shuffled_ball(0.07), tangled = shuffled_ball(0.2), open = shuffled_ball(0.07);
  open.triangles.pop_back();
  const Repair repaired = repair_surface(good, {});
  EXPECT_TRUE(repaired.check.valid());
  EXPECT_GT(repaired.tidied.vertices_moved, 0u);
  EXPECT_TRUE(repair_surface(tangled, {}).check.valid());
  EXPECT_FALSE(repair_surface(open, {}).check.closed);

  TriMesh left_alone = shuffled_ball(0.2);
  const auto before = left_alone.vertices;
  const Repair none = repair_surface(left_alone, {.shape = 0, .untangle_rounds = 0});
  EXPECT_EQ(left_alone.vertices, before);
  EXPECT_EQ(none.check.self_intersections, self_intersections(left_alone).pairs.size());
  EXPECT_GT(none.check.self_intersections, 0u);
}

TEST(Untangle, RefusesVerticesThatAreNotFinite) {
  TriMesh mesh = icosphere(1);
  mesh.vertices[3][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(untangle(mesh, 1), InputError);
}

}  // namespace
}  // namespace dynasurf::mesh
