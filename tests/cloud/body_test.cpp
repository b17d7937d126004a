#include "dynasurf/cloud/detail/body.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/synthetic/detail/random.hpp"

namespace dynasurf::cloud {
namespace {

constexpr int nodes = 61;
constexpr double radius = 20, slope = 0.2;  // in cells, and of the value over a cell

constexpr double none = -radius;

/// A ball with a tunnel of this radius through it; its surfaces at levels up to 0.2 lie up to a cell off.
IndicatorField ball(double tunnel) {
  IndicatorField field;
  field.value.grid.dims = {nodes, nodes, nodes};
  field.value.values.resize(field.value.grid.size());
  const Vec3 middle = Vec3::Constant(nodes / 2);
  for (int k = 0; k < nodes; ++k)
    for (int j = 0; j < nodes; ++j)
      for (int i = 0; i < nodes; ++i) {
        const Vec3 p = Vec3(i, j, k) - middle;
        const double inside = std::min(radius - p.norm(), std::hypot(p[0], p[1]) - tunnel);
        field.value(i, j, k) = static_cast<float>(std::clamp(slope * inside, -0.5, 0.5));
      }
  return field;
}

std::vector<Vec3> sphere() {
  synthetic::Random random(7);
  std::vector<Vec3> points;
  for (int n = 0; n < 4000; ++n) {
    const Vec3 way = Vec3(random.normal(), random.normal(), random.normal()).normalized();
    points.push_back(Vec3::Constant(nodes / 2) + radius * way);
  }
  return points;
}

// Within a tunnel's mouths of half an angle of 30 degrees lie 1 - cos 30 of the points, 13.4 %.
TEST(Body, TellsPointsThatASurfacePassesBy) {
  const std::vector<Vec3> points = sphere();
  const IndicatorField whole = ball(none), holed = ball(10);
  EXPECT_LT(share_passed_by(whole, 0, points, 1.5), 0.002);
  EXPECT_EQ(share_passed_by(whole, 0.4, points, 1.5), 1) << "its surface lies 2 cells inside";
  EXPECT_LT(share_passed_by(whole, 0.4, points, 3), 0.002);
  // What is left of the mouths farther than 1.5 cells from their rims: angles up to asin(8.5 / 20).
  EXPECT_NEAR(share_passed_by(holed, 0, points, 1.5), 1 - std::sqrt(1 - 0.425 * 0.425), 0.02);
}

TEST(Body, IsFirmWherePointsContradictWhatIsElse) {
  const std::vector<Vec3> points = sphere();
  const std::vector<IndicatorField> alike{ball(none), ball(none)}, torn{ball(10), ball(none)},
      pricked{ball(3), ball(none)};
  EXPECT_EQ(firmness_of(alike, points, 0.01, {1, 0}, 1.5), 1);
  EXPECT_EQ(firmness_of(alike, points, 0.01, {1, 1}, 1.5), 0) << "no surface is of this kind";
  EXPECT_EQ(firmness_of(torn, points, 0.01, {1, 0}, 1.5), 1) << "13 % of the points lie in the mouths";
  EXPECT_EQ(firmness_of(pricked, points, 0.01, {1, 0}, 1.5), 0.5) << "1 % of the points do";
}

}  // namespace
}  // namespace dynasurf::cloud
