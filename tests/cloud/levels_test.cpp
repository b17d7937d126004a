#include "dynasurf/cloud/detail/levels.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "dynasurf/mesh/detail/sample_surface.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/repair.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::cloud {
namespace {

/// An ellipsoid whose diagonal is about 1.
Vec3 on_ellipsoid(const Vec3& direction) { return direction.normalized().cwiseProduct(Vec3(0.35, 0.3, 0.2)); }

TriMesh ellipsoid(int level) {
  TriMesh mesh = mesh::icosphere(level);
  for (Vec3& p : mesh.vertices) p = on_ellipsoid(p);
  return mesh;
}

struct Scan {
  std::vector<Vec3> points, normals;
};
Scan scan_of_ellipsoid(std::size_t count) {
  const TriMesh sphere = mesh::icosphere(5);
  Scan scan;
  for (const mesh::SurfaceSample& s : mesh::sample_surface(sphere, count)) {
    scan.points.push_back(on_ellipsoid(mesh::position_of(sphere, s)));
    scan.normals.push_back(scan.points.back().cwiseQuotient(Vec3(0.35, 0.3, 0.2).cwiseAbs2()).normalized());
  }
  return scan;
}

/// The level of so many triangles from an ellipsoid of 5120, and what `make_level` said.
std::pair<TriMesh, std::size_t> level_of(std::size_t triangles, const LevelPlan& plan, const Scan& scan) {
  const TriMesh fine = ellipsoid(4);
  mesh::SurfaceEditor surface(fine);
  const std::size_t count =
      make_level(surface, triangles, fine, mesh::ClosestPoint(fine), {scan.points, scan.normals}, plan);
  return {surface.mesh(), count};
}

TEST(MakeLevel, LeavesAClosedSurfaceOfTheTrianglesAskedFor) {
  const Scan scan = scan_of_ellipsoid(20000);
  for (const LevelPlan& plan : {shaped_plan(), faithful_plan()})
    for (const std::size_t triangles : {1280U, 320U, 80U}) {
      const auto [mesh, count] = level_of(triangles, plan, scan);
      EXPECT_EQ(count, triangles);
      EXPECT_EQ(mesh.triangles.size(), triangles);
      EXPECT_TRUE(mesh::check_surface(mesh).valid()) << triangles;
      EXPECT_EQ(mesh.vertices.size(), triangles / 2 + 2) << "of genus 0";
    }
}

TEST(MakeLevel, HasNoAngleBelowThePlans) {
  const auto [mesh, count] = level_of(640, shaped_plan(), scan_of_ellipsoid(20000));
  EXPECT_GE(mesh::triangle_quality(mesh).smallest_angle_deg, shaped_plan().smallest_angle_deg);
}

TEST(MakeLevel, LiesNearerToThePointsThanCollapsedEdgesDo) {
  const Scan scan = scan_of_ellipsoid(20000);
  const TriMesh fine = ellipsoid(4);
  mesh::SurfaceEditor collapsed(fine), fitted(fine);
  make_lighter(collapsed, 320);
  make_level(fitted, 320, fine, mesh::ClosestPoint(fine), {scan.points, scan.normals}, shaped_plan());
  // Chords cut the convex body off; the fit lets them pass through it, half the distance away.
  EXPECT_LT(mean_distance(fitted, scan.points), 0.6 * mean_distance(collapsed, scan.points));
}

// The next level starts from what is begun, while this one is finished.
TEST(LevelMaker, BeginsWithASoundSurfaceThatFinishingBringsNearer) {
  const Scan scan = scan_of_ellipsoid(20000);
  const TriMesh fine = ellipsoid(4);
  const mesh::ClosestPoint on_fine(fine);
  mesh::SurfaceEditor collapsed(fine), surface(fine);
  make_lighter(collapsed, 1280);
  const LevelMaker maker(fine, on_fine, {scan.points, scan.normals}, 1280, shaped_plan());
  maker.begin(surface);
  const TriMesh begun = surface.mesh();
  EXPECT_EQ(begun.triangles.size(), 1280U);
  EXPECT_TRUE(mesh::check_surface(begun).valid());
  const double before = mean_distance(surface, scan.points);
  EXPECT_LT(before, 0.6 * mean_distance(collapsed, scan.points)) << "it is fitted";
  maker.finish(surface);
  EXPECT_TRUE(mesh::check_surface(surface.mesh()).valid());
  EXPECT_LT(mean_distance(surface, scan.points), before);
}

TEST(MakeLevel, AddsTrianglesWhereTheSurfaceHasTooFew) {
  const Scan scan = scan_of_ellipsoid(20000);
  const TriMesh coarse = ellipsoid(2);
  mesh::SurfaceEditor surface(coarse);
  EXPECT_EQ(make_level(surface, 1000, coarse, mesh::ClosestPoint(coarse), {scan.points, scan.normals}, shaped_plan()),
            1000U);
  EXPECT_TRUE(mesh::check_surface(surface.mesh()).valid());
}

TEST(StepOfFit, UsesAtMostSoManyPointsForEachTriangle) {
  LevelPlan plan;
  plan.points_per_triangle = 10, plan.fewest_points = 1000;
  EXPECT_EQ(step_of_fit(plan, 500, 80), 1U) << "all where there are few";
  for (const std::size_t points : {5000U, 20000U, 100000U})
    for (const std::size_t triangles : {80U, 320U, 1280U}) {
      const std::size_t used = points / step_of_fit(plan, points, triangles);
      EXPECT_GE(used, std::min<std::size_t>(points, 1000) / 2);
      EXPECT_LE(static_cast<double>(used), std::max(1000.0, 10.0 * static_cast<double>(triangles)) * 2);
    }
}

}  // namespace
}  // namespace dynasurf::cloud
