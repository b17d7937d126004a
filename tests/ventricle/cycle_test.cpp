// Gates that help each other: slices that are worth looking at, and surfaces that start from the gate before.
#include "dynasurf/ventricle/detail/cycle.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/presets.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf::ventricle {
namespace {

Study stack() {
  Grid g;
  g.dims = {32, 32, 30};
  g.spacing = {4, 4, 5};
  Study study;
  study.gates.emplace_back(g, 1.f);
  return study;
}

/// A heart on the axis of the stack, its outer apex at 30 mm and its base at 100 mm.
Location heart_in_the_stack() {
  Location heart;
  heart.cup.axis = Vec3(0, 0, 1);
  heart.cup.centre = Vec3(62, 62, 60);
  heart.cup.radius_mm = 30, heart.cup.half_length_mm = 30, heart.cup.base_mm = 40;
  return heart;
}

TEST(UsefulSlices, AreAllWithoutAHeart) {
  const SliceRange range = useful_slices(stack(), std::nullopt, {std::nullopt}, {});
  EXPECT_EQ(range.first, 0);
  EXPECT_EQ(range.last, 29);
}

TEST(UsefulSlices, ReachFromTheApexToBeyondTheBase) {
  const Location heart = heart_in_the_stack();
  const SliceRange range = useful_slices(stack(), heart, {std::nullopt}, {});
  EXPECT_LE(5.0 * range.first, heart.cup.apex()[2]);
  EXPECT_GE(5.0 * (range.first + 3), heart.cup.apex()[2] - 10);
  EXPECT_GE(5.0 * range.last, heart.cup.base()[2]);
  EXPECT_LT(range.last, 29);
}

TEST(UsefulSlices, FollowTheValvePlaneAndThePerson) {
  const Location heart = heart_in_the_stack();
  const SliceRange without = useful_slices(stack(), heart, {std::nullopt}, {});
  BasePlane high;
  high.point = heart.cup.base() + Vec3(0, 0, 30);
  high.normal = Vec3(0, 0, 1);
  EXPECT_GT(useful_slices(stack(), heart, {high}, {}).last, without.last);
  UserOverrides said;
  said.first_slice = 8;
  said.last_slice = 400;
  const SliceRange range = useful_slices(stack(), heart, {high}, said);
  EXPECT_EQ(range.first, 7);
  EXPECT_EQ(range.last, 29);
}

TEST(UsefulSlices, LeaveNoEdgeOutsideThem) {
  Mask edges(stack().grid(), 1);
  clear_outside(edges, {4, 9});
  for (int k = 0; k < 30; ++k) EXPECT_EQ(edges(3, 5, k), k >= 4 && k <= 9) << k;
}

TEST(WarmStart, TakesFewerStepsToTheSameVolumes) {
  // Within 2 %: a surface that starts near its border rests on other voxels of its thickness than one from afar.
  synthetic::VirtualPatient patient;
  patient.gates = 4;
  const Study study = synthetic::make_phantom(patient).study;
  Options options = preset("edges");
  const Result cold = reconstruct(study, options);
  options.warm_start = true;
  const Result warm = reconstruct(study, options);
  int cold_steps = 0, warm_steps = 0;
  for (std::size_t g = 1; g < 4; ++g)
    for (const Border wall : {Border::endo, Border::epi}) {
      const auto &from_afar = cold.gates[g].edge_surfaces.of(wall), &near = warm.gates[g].edge_surfaces.of(wall);
      ASSERT_TRUE(from_afar && near);
      cold_steps += from_afar->steps, warm_steps += near->steps;
      EXPECT_NEAR(near->volume_ml, from_afar->volume_ml, 0.02 * from_afar->volume_ml) << g << name_of(wall);
    }
  EXPECT_LT(warm_steps, 0.8 * cold_steps);
  EXPECT_EQ(warm.gates[0].edge_surfaces.epi->volume_ml, cold.gates[0].edge_surfaces.epi->volume_ml);
}

// Walls of 15 to 21 mm and an inner wall as smooth as no heart has it, seen without noise.
TEST(ThesisCycle, IsReadRightByDefault) {
  const synthetic::Phantom phantom = synthetic::make_phantom(synthetic::CardiacCycle{});
  const Result result = reconstruct(phantom.study, preset("psf_corrected"));
  ASSERT_TRUE(result.readings.psf_corrected && result.leading.ef_percent);
  EXPECT_NEAR(result.leading.edv_ml->value / *phantom.edv_ml, 1, 0.03);
  EXPECT_NEAR(result.leading.esv_ml->value / *phantom.esv_ml, 1, 0.04);
  EXPECT_NEAR(result.leading.ef_percent->value, *phantom.ef_percent, 1.5);
  EXPECT_NEAR(result.leading.wall_ml->value / phantom.truth.front().wall_ml(), 1, 0.03);
  EXPECT_EQ(result.verdict, Verdict::ok);
}

TEST(ThesisCycle, KeepsItsEjectionFractionByEdges) {
  const synthetic::Phantom phantom = synthetic::make_phantom(synthetic::CardiacCycle{});
  const Result result = reconstruct(phantom.study, preset("edges"));
  ASSERT_TRUE(result.leading.ef_percent);
  EXPECT_NEAR(result.leading.ef_percent->value, *phantom.ef_percent, 3);
}

}  // namespace
}  // namespace dynasurf::ventricle
