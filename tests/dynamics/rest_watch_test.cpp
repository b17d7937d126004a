#include "dynasurf/dynamics/detail/rest_watch.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dynasurf::dynamics {
namespace {

/// The first of `steps` steps after which a particle that moves along `path` is at rest; -1: none.
template <class Path>
int first_rest(Path path, int steps) {
  StepPlan plan;
  plan.rest_mm = 1e-3;
  plan.stray_mm = 0.1;
  plan.stray_steps = 100;
  const Vec3 start = path(0);
  RestWatch watch(std::span(&start, 1));
  const std::uint32_t moving = 0;
  for (int step = 1; step <= steps; ++step) {
    const Vec3 before = path(step - 1), now = path(step);
    if (watch.count(std::span(&moving, 1), std::span(&now, 1), std::span(&before, 1), step, plan) == 1) return step;
  }
  return -1;
}

TEST(RestWatch, TakesWhoMovesLittleForResting) {
  EXPECT_EQ(first_rest([](int s) { return Vec3(0.9e-3 * s, 0, 0); }, 10), 1);
  EXPECT_EQ(first_rest([](int s) { return Vec3(1.1e-3 * s, 0, 0); }, 5000), -1) << "it gets on, however slowly";
}

TEST(RestWatch, TakesWhoGetsNowhereForRestingTheLaterTheWiderItStrays) {
  // To and fro by 0.05, 0.15, 0.3 and 0.7 mm: balls of 0.1, 0.2, 0.4 and 0.8 mm hold it.
  int former = 0;
  for (const auto& [width, after] : {std::pair{0.05, 100}, {0.15, 200}, {0.3, 400}, {0.7, 800}}) {
    const int rest = first_rest([w = width](int s) { return Vec3(s % 2 == 0 ? 0 : w, 0, 0); }, 2000);
    EXPECT_GE(rest, after) << width;
    EXPECT_LE(rest, after + 2) << width;
    EXPECT_GT(rest, former);
    former = rest;
  }
  EXPECT_EQ(first_rest([](int s) { return Vec3(s % 2 == 0 ? 0 : 0.9, 0, 0); }, 5000), -1);
}

}  // namespace
}  // namespace dynasurf::dynamics
