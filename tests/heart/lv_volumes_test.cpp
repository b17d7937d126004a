#include "dynasurf/heart/lv_volumes.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace dynasurf::heart {
namespace {

// Table 6.16 of the thesis, mL.
const std::vector<double> thesis_cycle{74.741, 45.677, 36.523, 32.956, 47.237, 55.825, 63.133, 79.581};

TEST(LvVolumes, ReproducesTheEjectionFractionOfTable616) {
  const auto f = lv_volumes(thesis_cycle);
  ASSERT_TRUE(f && f->ef_percent);
  EXPECT_NEAR(*f->ef_percent, 58.6, 0.05);  // published to one decimal
  EXPECT_EQ(f->ed_gate, 7);
  EXPECT_EQ(f->es_gate, 3);
  EXPECT_NEAR(f->sv_ml, 46.625, 1e-12);
}

TEST(LvVolumes, HasNoEjectionFractionWithoutABeatOrACavity) {
  EXPECT_FALSE(lv_volumes(std::vector<double>{}));
  EXPECT_FALSE(lv_volumes(std::vector<double>{80}));
  const auto f = lv_volumes(std::vector<double>{0, 0, 0});
  ASSERT_TRUE(f);
  EXPECT_FALSE(f->ef_percent);
}

TEST(LvVolumes, IgnoresTheScaleOfTheVolumes) {
  std::vector<double> doubled = thesis_cycle;
  for (double& v : doubled) v *= 2;
  EXPECT_DOUBLE_EQ(*lv_volumes(doubled)->ef_percent, *lv_volumes(thesis_cycle)->ef_percent);
}

TEST(CurvePhases, FindsFastFallFastRiseAndSlowRise) {
  const auto p = phases_of_curve(std::vector<double>{100, 70, 45, 40, 60, 82, 86, 92});
  ASSERT_TRUE(p);
  EXPECT_EQ(p->end_diastole, 0);
  EXPECT_EQ(p->end_systole, 3);
  EXPECT_EQ(p->end_rapid_filling, 5);
}

TEST(CurvePhases, CountsAroundTheCycle) {
  // The same beat, started two gates later.
  const auto p = phases_of_curve(std::vector<double>{45, 40, 60, 82, 86, 92, 100, 70});
  ASSERT_TRUE(p);
  EXPECT_EQ(p->end_diastole, 6);
  EXPECT_EQ(p->end_systole, 1);
  EXPECT_EQ(p->end_rapid_filling, 3);
}

TEST(CurvePhases, AreAbsentForAFlatOrShortCurve) {
  EXPECT_FALSE(phases_of_curve(std::vector<double>{5, 5, 5, 5}));
  EXPECT_FALSE(phases_of_curve(std::vector<double>{5, 3, 4}));
}

TEST(CoefficientOfVariation, IsStandardDeviationOverMean) {
  EXPECT_DOUBLE_EQ(coefficient_of_variation(std::vector<double>{1, 3}), std::sqrt(2.0) / 2);
  EXPECT_EQ(coefficient_of_variation(std::vector<double>{4, 4, 4}), 0);
  EXPECT_EQ(coefficient_of_variation(std::vector<double>{4}), 0);
}

TEST(CycleRoughness, IsNothingForWavesAndLargeForOneGateThatJumps) {
  std::vector<double> smooth, jump;
  for (int g = 0; g < 8; ++g) smooth.push_back(100 + 30 * std::cos(2 * M_PI * g / 8) + 10 * std::sin(4 * M_PI * g / 8));
  EXPECT_NEAR(cycle_roughness(smooth), 0, 1e-12);
  jump = smooth;
  jump[3] += 40;
  // Of one jump in 8 values, 3 of the 7 free parts are left: 40 sqrt(3/8) over sqrt(3) free ones, over the mean of 105.
  EXPECT_NEAR(cycle_roughness(jump), 40 / std::sqrt(8.0) / 105, 1e-12);
  EXPECT_EQ(cycle_roughness(std::vector<double>{1, 9, 1}), 0) << "too few to tell";
}

}  // namespace
}  // namespace dynasurf::heart
