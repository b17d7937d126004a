#include "dynasurf/ventricle/measures/detail/wall_thickness.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf::ventricle {
namespace {

TriMesh ellipsoid(const Vec3& half, const Vec3& centre, int level = 4) {
  TriMesh mesh = mesh::icosphere(level);
  for (Vec3& p : mesh.vertices) p = centre + p.cwiseProduct(half);
  return mesh;
}

/// A frame whose base plane leaves the whole surface below it.
HeartAxes open_axes() {
  HeartAxes axes;
  axes.apex = {0, 0, -100};
  axes.length_mm = 300;
  return axes;
}

TEST(WallThickness, IsThatOfASphericalShell) {
  const WallThickness wall =
      wall_thickness(ellipsoid({20, 20, 20}, {5, 4, 3}), ellipsoid({30, 30, 30}, {5, 4, 3}), open_axes());
  ASSERT_TRUE(wall.summary);
  // Between two polyhedra of 5120 triangles; the outer one's faces lie up to 0.03 mm inside its sphere.
  for (std::size_t v = 0; v < wall.endo.mm.size(); ++v) {
    ASSERT_EQ(wall.endo.source[v], ThicknessSource::ray) << v;
    ASSERT_NEAR(wall.endo.mm[v], 10, 0.05) << v;
    ASSERT_NEAR(wall.epi.mm[v], 10, 0.05) << v;
  }
  EXPECT_NEAR(wall.summary->mean_mm, 10, 0.02);
  EXPECT_LT(wall.summary->sd_mm, 0.02);
  EXPECT_EQ(wall.summary->nearest + wall.summary->crossing, 0);
}

TEST(WallThickness, IsThatOfAnEllipsoidalShellAlongItsAxes) {
  // Normals at the six ends of the axes run along the axes, so the thickness there is the difference of the half axes.
  const WallThickness wall =
      wall_thickness(ellipsoid({20, 25, 40}, Vec3::Zero()), ellipsoid({28, 36, 45}, Vec3::Zero()), open_axes());
  const TriMesh sphere = mesh::icosphere(4);
  int ends = 0;
  for (std::size_t v = 0; v < sphere.vertices.size(); ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(std::abs(sphere.vertices[v][axis]) - 1) < 1e-9) {
        EXPECT_NEAR(wall.endo.mm[v], Vec3(8, 11, 5)[axis], 0.1) << axis;  // facets and their normals
        EXPECT_NEAR(wall.epi.mm[v], Vec3(8, 11, 5)[axis], 0.1) << axis;
        ++ends;
      }
  EXPECT_EQ(ends, 6);
  ASSERT_TRUE(wall.summary);
  EXPECT_GT(wall.summary->min_mm, 4.5);
  EXPECT_LT(wall.summary->max_mm, 13);
}

TEST(WallThickness, OfTheHebronPhantomIs15Millimetres) {
  const synthetic::Phantom hebron = synthetic::make_phantom(synthetic::PhantomOptions{synthetic::Hebron{}});
  const synthetic::TrueGate& truth = hebron.truth.front();
  ASSERT_FALSE(truth.endo.vertices.empty());
  const auto axes = axes_of(truth.endo, truth.epi, Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(0, -1, 0), std::nullopt);
  ASSERT_TRUE(axes);
  const WallThickness wall = wall_thickness(truth.endo, truth.epi, *axes, 5);
  ASSERT_TRUE(wall.summary);
  EXPECT_NEAR(wall.summary->mean_mm, 15, 0.1);  // facets of the filled surfaces
  EXPECT_LT(wall.summary->sd_mm, 0.2);
  EXPECT_EQ(wall.summary->crossing, 0);
}

TEST(WallThickness, FlagsSurfacesThatCross) {
  const WallThickness wall =
      wall_thickness(ellipsoid({20, 20, 20}, {8, 0, 0}), ellipsoid({25, 25, 25}, {0, 0, 0}), open_axes());
  ASSERT_TRUE(wall.summary);
  EXPECT_GT(wall.summary->crossing, 0);
  for (std::size_t v = 0; v < wall.endo.mm.size(); ++v)
    EXPECT_EQ(wall.endo.source[v] == ThicknessSource::crossing, wall.endo.mm[v] < 0);
}

TEST(WallThickness, TakesTheNearestDistanceWhereNoRayHits) {
  const WallThickness wall =
      wall_thickness(ellipsoid({20, 20, 20}, Vec3::Zero()), ellipsoid({30, 30, 30}, Vec3::Zero()), open_axes(), 2, 5);
  EXPECT_FALSE(wall.summary);
  for (std::size_t v = 0; v < wall.endo.mm.size(); ++v) {
    EXPECT_EQ(wall.endo.source[v], ThicknessSource::nearest);
    EXPECT_NEAR(wall.endo.mm[v], 10, 0.1);
  }
}

TEST(WallThickness, LeavesTheLidOut) {
  HeartAxes axes = open_axes();
  axes.length_mm = 110;  // the plane at z = 10
  const TriMesh endo = ellipsoid({20, 20, 20}, Vec3::Zero());
  const WallThickness wall = wall_thickness(endo, ellipsoid({30, 30, 30}, Vec3::Zero()), axes);
  for (std::size_t v = 0; v < endo.vertices.size(); ++v)
    EXPECT_EQ(wall.endo.source[v] == ThicknessSource::lid, endo.vertices[v][2] > 8) << v;
}

}  // namespace
}  // namespace dynasurf::ventricle
