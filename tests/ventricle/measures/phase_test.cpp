#include "dynasurf/ventricle/measures/detail/phase.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace dynasurf::ventricle {
namespace {

std::vector<double> wave(int gates, double onset_deg, double amplitude) {
  std::vector<double> values;
  for (int g = 0; g < gates; ++g)
    values.push_back(100 + amplitude * std::sin((360 * (g + 0.5) / gates - onset_deg) * std::numbers::pi / 180));
  return values;
}

TEST(OnsetPhase, IsWhereTheWaveRisesThroughItsMean) {
  for (const double onset : {0.0, 33.0, 140.0, 271.0, 359.0})
    for (const int gates : {8, 16}) {
      const auto phase = onset_phase_deg(wave(gates, onset, 10));
      ASSERT_TRUE(phase);
      EXPECT_NEAR(std::remainder(*phase - onset, 360.0), 0, 1e-9) << onset;
    }
}

TEST(OnsetPhase, DoesNotSeeHigherWaves) {
  std::vector<double> values = wave(8, 60, 10);
  for (int g = 0; g < 8; ++g)
    values[static_cast<std::size_t>(g)] += 4 * std::cos(2 * std::numbers::pi * 2 * (g + 0.5) / 8);
  EXPECT_NEAR(onset_phase_deg(values).value(), 60, 1e-9);
}

TEST(OnsetPhase, IsAbsentWithoutAWave) {
  EXPECT_FALSE(onset_phase_deg(std::vector<double>{1, 2, 1}));
  EXPECT_FALSE(onset_phase_deg(std::vector<double>(8, 5.0), 1e-6));
  EXPECT_FALSE(onset_phase_deg(wave(8, 40, 1), 2));
}

TEST(PhaseSummary, OfTwoEqualHalvesIsKnown) {
  const std::vector<std::optional<double>> phases{10, 10, 30, 30};
  const std::vector<double> weights(4, 1.0);
  const auto s = summarise_phases(phases, weights);
  ASSERT_TRUE(s);
  EXPECT_NEAR(s->mean_deg, 20, 1e-9);
  EXPECT_NEAR(s->sd_deg, 10, 1e-9);
  EXPECT_NEAR(s->bandwidth_deg, 20, 1e-9);
  EXPECT_NEAR(s->entropy_percent, 100 * std::log(2.0) / std::log(60.0), 1e-9);
  EXPECT_NEAR(s->histogram_percent[1], 50, 1e-9);
}

TEST(PhaseSummary, DoesNotDependOnWhereTheBeatBegins) {
  std::vector<std::optional<double>> phases;
  std::vector<double> weights;
  for (int n = 0; n < 200; ++n) phases.push_back(350 + 0.1 * n + 5 * std::sin(n)), weights.push_back(1 + n % 3);
  const auto a = summarise_phases(phases, weights);
  for (auto& p : phases) p = *p + 120;
  const auto b = summarise_phases(phases, weights);
  ASSERT_TRUE(a && b);
  EXPECT_NEAR(std::remainder(b->mean_deg - a->mean_deg, 360.0), 120, 1e-9);
  EXPECT_NEAR(a->sd_deg, b->sd_deg, 1e-9);
  EXPECT_NEAR(a->bandwidth_deg, b->bandwidth_deg, 1e-9);
  EXPECT_NEAR(a->entropy_percent, b->entropy_percent, 1e-9);  // 120 is a whole number of bins
}

TEST(PhaseSummary, LeavesFivePercentOutOfTheBandwidth) {
  std::vector<std::optional<double>> phases;
  for (int n = 0; n < 96; ++n) phases.push_back(100 + n * 0.1);
  for (int n = 0; n < 4; ++n) phases.push_back(250);
  const std::vector<double> weights(100, 1.0);
  const auto s = summarise_phases(phases, weights);
  ASSERT_TRUE(s);
  EXPECT_NEAR(s->bandwidth_deg, 9.4, 1e-6);  // 95 of the 96 neighbours
}

TEST(PhaseSummary, OfEqualPhasesHasNoSpreadAndOfAllPhasesAllEntropy) {
  const std::vector<std::optional<double>> same(5, 77.0);
  const auto s = summarise_phases(same, std::vector<double>(5, 2.0));
  ASSERT_TRUE(s);
  EXPECT_NEAR(s->sd_deg, 0, 1e-6);
  EXPECT_NEAR(s->bandwidth_deg, 0, 1e-9);
  EXPECT_NEAR(s->entropy_percent, 0, 1e-9);
  std::vector<std::optional<double>> all;
  for (int n = 0; n < 60; ++n) all.push_back(6 * n + 3);
  EXPECT_NEAR(summarise_phases(all, std::vector<double>(60, 1.0))->entropy_percent, 100, 1e-9);
}

TEST(PhaseSummary, CountsWhatHasNoPhase) {
  const std::vector<std::optional<double>> phases{50, std::nullopt, 50, std::nullopt};
  const auto s = summarise_phases(phases, std::vector<double>{1, 1, 1, 1});
  ASSERT_TRUE(s);
  EXPECT_DOUBLE_EQ(s->wall_share, 0.5);
  EXPECT_FALSE(summarise_phases(std::vector<std::optional<double>>(3), std::vector<double>(3, 1.0)));
}

}  // namespace
}  // namespace dynasurf::ventricle
