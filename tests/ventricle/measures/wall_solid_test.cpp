#include "dynasurf/ventricle/measures/wall_solid.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/ventricle_shape.hpp"

namespace dynasurf::ventricle {
namespace {

const synthetic::VentricleMotion motion{110, 44, 120, 1.65, 12};

std::optional<WallSolid> solid_of(const synthetic::VentricleShape& shape, const WallSolidSize& size,
                                  TriMesh* endo = nullptr) {
  const TriMesh inner = synthetic::endo_surface(shape), outer = synthetic::epi_surface(shape);
  if (endo) *endo = inner;
  const auto axes = axes_of(inner, outer, Vec3(0, 0, shape.centre_z), Vec3(0, 0, 1), Vec3(0, -1, 0), std::nullopt);
  return axes ? wall_solid(inner, outer, *axes, size) : std::nullopt;
}

TEST(WallSolid, HoldsTheWallExactlyAndTurnsNothingInsideOut) {
  for (const double volume : {110.0, 70.0, 44.0})
    for (const WallSolidSize& size : {WallSolidSize{}, WallSolidSize{12, 32, 1}, WallSolidSize{48, 128, 2}}) {
      TriMesh endo;
      const synthetic::VentricleShape shape = synthetic::shape_at(motion, volume);
      const auto solid = solid_of(shape, size, &endo);
      ASSERT_TRUE(solid);
      EXPECT_EQ(solid->quality.not_positive, 0u);
      EXPECT_NEAR(solid->surfaces_ml, (mesh::volume_mm3(synthetic::epi_surface(shape)) - mesh::volume_mm3(endo)) / 1000,
                  1e-6);
      EXPECT_NEAR(solid->volume_ml, solid->surfaces_ml, 1e-6 * solid->surfaces_ml) << volume;
    }
}

TEST(WallSolid, MovesItsSurfacesLessTheFinerItIs) {
  const synthetic::VentricleShape shape = synthetic::shape_at(motion, 80);
  const double coarse = solid_of(shape, {12, 32, 1})->moved_mm, fine = solid_of(shape, {24, 64, 1})->moved_mm;
  EXPECT_GT(fine, 0);
  EXPECT_LT(fine, 0.35 * coarse);  // second order: a quarter, and the facets of the surfaces
  EXPECT_LT(fine, 0.1);
}

TEST(WallSolid, KeepsItsTetrahedraOverTheBeatAndNamesItsVertices) {
  const auto a = solid_of(synthetic::shape_at(motion, 110), {}), b = solid_of(synthetic::shape_at(motion, 44), {});
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->mesh.tetrahedra, b->mesh.tetrahedra);
  ASSERT_EQ(a->ring.size(), a->mesh.vertices.size());
  ASSERT_EQ(a->layer.size(), a->mesh.vertices.size());
  const double base = synthetic::shape_at(motion, 110).base_z;
  for (std::size_t v = 0; v < a->ring.size(); ++v)
    if (a->ring[v] == 24) {
      EXPECT_NEAR(a->mesh.vertices[v][2], base, 1e-9);
    }
}

TEST(WallSolid, FollowsAValvePlaneThatLeans) {
  // A sphere in a sphere, cut by a plane that leans by 15 degrees: the wall below it is known.
  TriMesh endo = mesh::icosphere(5), epi = mesh::icosphere(5);
  for (Vec3& p : endo.vertices) p *= 20;
  for (Vec3& p : epi.vertices) p *= 30;
  const heart::BasePlane plane{{0, 0, 8}, Vec3(std::sin(15 * M_PI / 180), 0, std::cos(15 * M_PI / 180)), 0, 1};
  const auto axes = axes_of(endo, epi, Vec3::Zero(), Vec3(0, 0, 1), Vec3(0, -1, 0), plane);
  ASSERT_TRUE(axes);
  const auto solid = wall_solid(endo, epi, *axes, {64, 160, 2});
  ASSERT_TRUE(solid);
  EXPECT_EQ(solid->quality.not_positive, 0u);
  const double height = 8 * std::cos(15 * M_PI / 180);
  const auto below = [&](double r) {
    return M_PI * (2 * r * r * r / 3 + r * r * height - height * height * height / 3);
  };
  // What it holds is what the spheres hold below the plane; what is left are their own facets.
  EXPECT_NEAR(solid->volume_ml * 1000, below(30) - below(20), 2e-3 * (below(30) - below(20)));
  EXPECT_NEAR(solid->volume_ml, solid->surfaces_ml, 1e-6 * solid->surfaces_ml);
}

TEST(WallSolid, EndsWhereItsSurfacesDo) {
  const synthetic::VentricleShape shape = synthetic::shape_at(motion, 80);
  const TriMesh inner = synthetic::endo_surface(shape), outer = synthetic::epi_surface(shape);
  // A valve plane that was found 3 mm too high.
  const heart::BasePlane plane{{0, 0, shape.base_z + 3}, Vec3(0, 0, 1), 0, 1};
  const auto axes = axes_of(inner, outer, Vec3(0, 0, shape.centre_z), Vec3(0, 0, 1), Vec3(0, -1, 0), plane);
  ASSERT_TRUE(axes);
  const auto solid = wall_solid(inner, outer, *axes, {48, 128, 1});
  ASSERT_TRUE(solid);
  EXPECT_DOUBLE_EQ(solid->lowered_mm, 3);
  EXPECT_NEAR(solid->volume_ml, solid->surfaces_ml, 1e-6 * solid->surfaces_ml);
  EXPECT_DOUBLE_EQ(solid_of(shape, {})->lowered_mm, 0);
}

TEST(WallSolid, IsAbsentWhereSurfacesCross) {
  TriMesh endo = mesh::icosphere(3), epi = mesh::icosphere(3);
  for (Vec3& p : endo.vertices) p = 20 * p + Vec3(9, 0, 0);
  for (Vec3& p : epi.vertices) p *= 25;
  const auto axes = axes_of(endo, epi, Vec3::Zero(), Vec3(0, 0, 1), Vec3(0, -1, 0), std::nullopt);
  ASSERT_TRUE(axes);
  EXPECT_FALSE(wall_solid(endo, epi, *axes));
  EXPECT_THROW(wall_solid(endo, epi, *axes, {1, 2, 0}), OptionError);
}

}  // namespace
}  // namespace dynasurf::ventricle
