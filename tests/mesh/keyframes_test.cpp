#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/motion.hpp"

#include "support/shapes.hpp"

namespace dynasurf::mesh {
namespace {

using namespace test_shapes;

/// A beat: sizes follow the cavity volumes of thesis table 6.16, with a sideways motion.
std::vector<TriMesh> beat(std::size_t n = 8) {
  const double volumes[] = {74741, 45677, 36523, 32956, 47237, 55825, 63133, 79581};
  std::vector<TriMesh> cycle;
  for (std::size_t g = 0; g < n; ++g)
    cycle.push_back(moved(ellipsoid(2, Vec3(1, 1.1, 1.4) * std::cbrt(volumes[g % 8] / 6.5)), Vec3(g % 3, 0, 1)));
  return cycle;
}

constexpr TimeInterpolation kBoth[] = {TimeInterpolation::linear, TimeInterpolation::periodic_cubic};

TEST(AtPhase, MeetsEveryKeyInItsOwnBytes) {
  for (const std::size_t n : {1U, 2U, 3U, 7U, 8U, 16U})
    for (const auto how : kBoth) {
      const auto cycle = beat(n);
      for (std::size_t g = 0; g < n; ++g)
        EXPECT_EQ(at_phase(cycle, static_cast<double>(g) / static_cast<double>(n), how).vertices, cycle[g].vertices)
            << word_of(how) << " " << g << "/" << n;
    }
}

TEST(AtPhase, IsHalfWayInTheMiddleWhenLinear) {
  const auto cycle = beat();
  const TriMesh m = at_phase(cycle, 7.5 / 8, TimeInterpolation::linear);  // between the last and the first
  for (std::size_t v = 0; v < m.vertices.size(); ++v)
    EXPECT_LT((m.vertices[v] - (cycle[7].vertices[v] + cycle[0].vertices[v]) / 2).norm(), 1e-12);
}

TEST(AtPhase, FollowsASineClosely) {
  // A periodic cubic spline errs by O(h^4): 16 times less with twice the keys.
  const auto worst_error = [](std::size_t n) {
    std::vector<TriMesh> cycle(n);
    for (std::size_t g = 0; g < n; ++g)
      cycle[g].vertices = {
          Vec3(std::sin(2 * std::numbers::pi * static_cast<double>(g) / static_cast<double>(n)), 1, 0)};
    double worst = 0;
    for (int f = 0; f < 1000; ++f) {
      const double x = at_phase(cycle, f / 1000.0, TimeInterpolation::periodic_cubic).vertices[0][0];
      worst = std::max(worst, std::abs(x - std::sin(2 * std::numbers::pi * f / 1000.0)));
    }
    return worst;
  };
  EXPECT_NEAR(worst_error(16) / worst_error(32), 16, 1);
}

/// Largest jump of the derivative of order 0, 1 or 2 across the keys, by one-sided differences of step h.
double jump_at_keys(const std::vector<TriMesh>& cycle, TimeInterpolation how, int order) {
  const double h = 1e-4;
  const auto n = static_cast<double>(cycle.size());
  double worst = 0;
  for (std::size_t g = 0; g < cycle.size(); ++g) {
    const auto x = [&](double s) { return at_phase(cycle, (static_cast<double>(g) + s) / n, how).vertices[7]; };
    const Vec3 zero = x(0), r1 = x(h), r2 = x(2 * h), r3 = x(3 * h), l1 = x(-h), l2 = x(-2 * h), l3 = x(-3 * h);
    Vec3 right = Vec3::Zero(), left = Vec3::Zero();
    if (order == 0) right = r1, left = l1;
    if (order == 1) right = (-3 * zero + 4 * r1 - r2) / (2 * h), left = (3 * zero - 4 * l1 + l2) / (2 * h);
    if (order == 2)
      right = (2 * zero - 5 * r1 + 4 * r2 - r3) / (h * h), left = (2 * zero - 5 * l1 + 4 * l2 - l3) / (h * h);
    worst = std::max(worst, (right - left).norm());
  }
  return worst;
}

TEST(AtPhase, IsSmoothToTheSecondDerivativeAroundTheWholeCycleWhenCubic) {
  // Differences cost rounding 1e-14/h^2 = 1e-6; values are of the order of 10 mm per interval.
  const auto cycle = beat();
  EXPECT_LT(jump_at_keys(cycle, TimeInterpolation::periodic_cubic, 0), 1e-2);
  EXPECT_LT(jump_at_keys(cycle, TimeInterpolation::periodic_cubic, 1), 1e-5);
  EXPECT_LT(jump_at_keys(cycle, TimeInterpolation::periodic_cubic, 2), 1e-3);
  EXPECT_LT(jump_at_keys(cycle, TimeInterpolation::linear, 0), 1e-2);
  EXPECT_GT(jump_at_keys(cycle, TimeInterpolation::linear, 1), 1);  // the test can see a corner
}

TEST(AtPhase, GivesAContinuousVolumeCurve) {
  const auto cycle = beat();
  for (const auto how : kBoth) {
    double last = volume_mm3(at_phase(cycle, 0, how));
    for (int f = 1; f <= 240; ++f) {
      const double now = volume_mm3(at_phase(cycle, f / 240.0, how));
      EXPECT_LT(std::abs(now - last), 2000);  // of 80000: thirty frames between two gates
      last = now;
    }
    EXPECT_EQ(last, volume_mm3(cycle[0]));  // phase 1 is phase 0
  }
}

TEST(AtPhase, RefusesMeshesOfDifferentTriangles) {
  auto cycle = beat();
  std::swap(cycle[3].triangles[0], cycle[3].triangles[1]);
  EXPECT_THROW(at_phase(cycle, 0.1, TimeInterpolation::linear), InputError);
  cycle[3] = icosphere(1);
  EXPECT_THROW(at_phase(cycle, 0.1, TimeInterpolation::linear), InputError);
  EXPECT_THROW(at_phase({}, 0.1, TimeInterpolation::linear), InputError);
  EXPECT_THROW(at_phase(beat(), std::nan(""), TimeInterpolation::linear), InputError);
}

}  // namespace
}  // namespace dynasurf::mesh
