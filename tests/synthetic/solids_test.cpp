#include "dynasurf/synthetic/detail/solids.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "mesh_checks.hpp"

namespace dynasurf::synthetic {
namespace {

TEST(CylinderCup, HasTheVolumesOfThePhantom) {
  EXPECT_NEAR(1000 * volume_ml(CylinderCup{35, 55}), 301461.995, 0.001);
  EXPECT_NEAR(1000 * volume_ml(CylinderCup{20, 55}), 85870.199, 0.001);
}

TEST(CylinderCup, ContainsItsHalfSphereAndItsCylinder) {
  const CylinderCup cup{20, 55};
  EXPECT_TRUE(cup.contains({0, 0, -19.9}));
  EXPECT_FALSE(cup.contains({0, 0, -20.1}));
  EXPECT_FALSE(cup.contains({15, 0, -15}));
  EXPECT_TRUE(cup.contains({15, 0, 15}));
  EXPECT_TRUE(cup.contains({0, 19.9, 54.9}));
  EXPECT_FALSE(cup.contains({0, 0, 55.1}));
}

TEST(Surfaces, AreFineClosedOrientedAndHoldTheVolumeOfTheirSolid) {
  for (const CylinderCup& cup : {CylinderCup{35, 55}, CylinderCup{20, 55}, CylinderCup{19, 10}}) {
    const TriMesh mesh = surface(cup);
    EXPECT_GE(mesh.vertices.size(), 10000u);
    EXPECT_TRUE(closed_and_oriented(mesh));
    // The rings keep the areas of their circles; what is left is the polygon of the meridian.
    EXPECT_NEAR(signed_volume_ml(mesh), volume_ml(cup), 5e-4 * volume_ml(cup));
  }
  const TriMesh ball = sphere_surface(18);
  EXPECT_GE(ball.vertices.size(), 10000u);
  EXPECT_TRUE(closed_and_oriented(ball));
  EXPECT_NEAR(signed_volume_ml(ball), 4.0 / 3 * M_PI * 5.832, 1e-3 * 24.43);
}

}  // namespace
}  // namespace dynasurf::synthetic
