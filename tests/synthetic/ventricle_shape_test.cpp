#include "dynasurf/synthetic/ventricle_shape.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"

#include "mesh_checks.hpp"

namespace dynasurf::synthetic {
namespace {

const VentricleMotion normal{110, 44, 120, 1.65, 12};

TEST(VentricleShape, HasTheVolumesAskedForThroughoutTheBeat) {
  for (const VentricleMotion& m :
       {normal, VentricleMotion{50, 15, 75, 1.5, 10}, VentricleMotion{250, 190, 160, 1.4, 5}})
    for (double part : {0.0, 0.25, 0.5, 1.0}) {
      const double volume = m.esv_ml + part * (m.edv_ml - m.esv_ml);
      const VentricleShape s = shape_at(m, volume);
      EXPECT_NEAR(endo_ml(s), volume, 1e-9 * volume);
      EXPECT_NEAR(epi_ml(s) - endo_ml(s), m.wall_ml, 1e-8 * m.wall_ml);
    }
}

TEST(VentricleShape, MovesItsBasePlaneAndThickensItsWall) {
  const VentricleShape ed = shape_at(normal, 110), es = shape_at(normal, 44);
  EXPECT_NEAR(ed.base_z - es.base_z, 12, 1e-9);
  EXPECT_NEAR((ed.base_z - (ed.epi_half_length - ed.endo_half_length)) / (2 * ed.endo_radius), 1.65, 1e-9);
  const double thick_ed = ed.epi_radius - ed.endo_radius, thick_es = es.epi_radius - es.endo_radius;
  // A normal wall is near 1 cm in diastole and thickens by a third to a half.
  EXPECT_GT(thick_ed, 8);
  EXPECT_LT(thick_ed, 12);
  EXPECT_GT(thick_es / thick_ed, 1.25);
  EXPECT_LT(thick_es / thick_ed, 1.7);
}

TEST(VentricleShape, HasFineClosedSurfacesOfTheSameTriangles) {
  const VentricleShape ed = shape_at(normal, 110), es = shape_at(normal, 44);
  for (const VentricleShape& s : {ed, es}) {
    for (const auto& [mesh, volume] : {std::pair{endo_surface(s), endo_ml(s)}, std::pair{epi_surface(s), epi_ml(s)}}) {
      EXPECT_GE(mesh.vertices.size(), 10000u);
      EXPECT_TRUE(closed_and_oriented(mesh));
      EXPECT_NEAR(signed_volume_ml(mesh), volume, 3e-4 * volume);
    }
  }
  EXPECT_EQ(endo_surface(ed).triangles, endo_surface(es).triangles);
  EXPECT_EQ(endo_surface(ed).triangles, epi_surface(es).triangles);
}

TEST(VentricleShape, KeepsItsSurfacesWhereItsInsideEnds) {
  const VentricleShape s = shape_at(normal, 70);
  for (const Vec3& p : endo_surface(s).vertices) {
    const Vec3 middle{0, 0, s.centre_z};
    EXPECT_TRUE(s.in_endo(middle + 0.998 * (p - middle)));
    EXPECT_FALSE(s.in_endo(middle + 1.002 * (p - middle)));
    EXPECT_TRUE(s.in_epi(middle + 0.998 * (p - middle)));
  }
}

TEST(VentricleShape, RefusesAMotionThatIsImpossible) {
  EXPECT_THROW(shape_at({110, 44, 120, 1.65, 80}, 44), OptionError);
}

TEST(Filling, RestsAtEndDiastoleAndEndSystoleAndIsPeriodic) {
  for (double phase : {0.0, 0.03, 0.0625, 0.98, 1.0, 2.0625}) EXPECT_DOUBLE_EQ(filling_at(phase), 1) << phase;
  for (double phase : {0.39, 0.40625, 0.4375}) EXPECT_NEAR(filling_at(phase), 0, 1e-12) << phase;
  EXPECT_NEAR(filling_at(0.3), filling_at(7.3), 1e-12);
}

TEST(Filling, FallsInSystoleRisesFastThenSlowlyThenWithTheAtria) {
  const auto rate = [](double phase) { return (filling_at(phase + 1e-4) - filling_at(phase - 1e-4)) / 2e-4; };
  EXPECT_LT(rate(0.2), -2);
  EXPECT_GT(rate(0.56), 3);
  EXPECT_GT(rate(0.75), 0);
  EXPECT_LT(rate(0.75), 0.8);
  EXPECT_GT(rate(0.9), 1.5);
  for (double phase = 0; phase < 1; phase += 0.001) {
    EXPECT_GE(filling_at(phase), 0);
    EXPECT_LE(filling_at(phase), 1);
    EXPECT_NEAR(filling_at(phase + 0.0005), filling_at(phase), 0.0005 * 6) << "jump at " << phase;
  }
}

}  // namespace
}  // namespace dynasurf::synthetic
