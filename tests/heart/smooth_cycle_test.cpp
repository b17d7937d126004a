#include "dynasurf/heart/detail/smooth_cycle.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dynasurf::heart {
namespace {

std::vector<std::optional<double>> wave(int gates) {
  std::vector<std::optional<double>> values;
  for (int g = 0; g < gates; ++g) {
    const double angle = 2 * std::numbers::pi * g / gates;
    values.emplace_back(30 + 5 * std::cos(angle) - 2 * std::sin(2 * angle));
  }
  return values;
}

TEST(SmoothCycle, KeepsWhatABeatMayDo) {
  for (const int gates : {6, 8, 16}) {
    const auto values = wave(gates);
    const SmoothCycle smooth = smooth_over_cycle(values, 3);
    for (std::size_t g = 0; g < values.size(); ++g) {
      EXPECT_NEAR(smooth.values[g], *values[g], 1e-3) << gates;
      EXPECT_FALSE(smooth.outlier[g]);
    }
  }
}

TEST(SmoothCycle, DoesNotFollowTheGateThatJumps) {
  auto values = wave(16);
  values[5] = *values[5] + 20;
  values[9] = std::nullopt;
  const SmoothCycle smooth = smooth_over_cycle(values, 3);
  for (std::size_t g = 0; g < 16; ++g) {
    EXPECT_NEAR(smooth.values[g], *wave(16)[g], 0.05);
    EXPECT_EQ(smooth.outlier[g], g == 5 || g == 9);
  }
}

TEST(SmoothCycle, OfFewGatesIsTheirMean) {
  const std::vector<std::optional<double>> values{1.0, 2.0, 3.0};
  for (const double v : smooth_over_cycle(values, 10).values) EXPECT_NEAR(v, 2, 0.02) << "robust weights are not even";
}

}  // namespace
}  // namespace dynasurf::heart
