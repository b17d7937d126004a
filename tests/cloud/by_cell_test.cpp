#include "dynasurf/cloud/detail/by_cell.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace dynasurf::cloud {
namespace {

TEST(ByCell, BringsPointsOfOneCellTogetherInTheirOrder) {
  constexpr double side = 0.25;
  const Vec3 origin(-1, 2, -3);
  std::mt19937 random(3);
  const auto share = [&] { return random() / (random.max() + 1.0); };
  std::vector<Vec3> points;
  for (int n = 0; n < 5000; ++n) {
    const double x = share(), y = share(), z = share();
    points.push_back(origin + 3 * Vec3(x, y, z));
  }
  // So far away along one axis that cells next to each other along the others might have the same number.
  for (int axis = 0; axis < 3; ++axis)
    points.push_back(origin + side * ((1 << 20) * Vec3::Unit(axis) + Vec3::Constant(0.5)));
  const std::vector<InCell> order = by_cell(points, origin, side);
  ASSERT_EQ(order.size(), points.size());
  const auto cell = [&](const InCell& p) -> Vec3 { return ((points[p.index] - origin) / side).array().floor(); };
  std::vector<int> seen(points.size(), 0);
  for (std::size_t n = 0; n < order.size(); ++n) {
    ++seen[order[n].index];
    if (n == 0) continue;
    const InCell &before = order[n - 1], &here = order[n];
    EXPECT_EQ(before.cell == here.cell, cell(before) == cell(here));
    EXPECT_TRUE(before.cell < here.cell || (before.cell == here.cell && before.index < here.index));
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), std::ssize(seen));
}

}  // namespace
}  // namespace dynasurf::cloud
