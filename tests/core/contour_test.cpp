#include "dynasurf/core/contour.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"

namespace dynasurf {
namespace {

TEST(Contour, MeasuresASquare) {
  const Contour square{{{1, 1}, {4, 1}, {4, 4}, {1, 4}}};
  EXPECT_DOUBLE_EQ(signed_area(square), 9);
  EXPECT_DOUBLE_EQ(length_of(square), 12);
  EXPECT_TRUE(centroid_of(square).isApprox(Vec2(2.5, 2.5)));
  EXPECT_TRUE(encloses(square, {2, 3}));
  EXPECT_FALSE(encloses(square, {5, 3}));
  EXPECT_DOUBLE_EQ(length_of({square.points, false}), 9);
}

TEST(Contour, TurnsTheSignOfItsAreaWithItsSense) {
  Contour c = circle_contour({3, -2}, 5, 1);
  EXPECT_GT(signed_area(c), 0);
  const double area = signed_area(c);
  std::reverse(c.points.begin(), c.points.end());
  EXPECT_NEAR(signed_area(c), -area, 1e-12);
}

TEST(SpreadEvenly, GivesEqualArcsStartedOnTheRay) {
  const Contour square{{{0, 0}, {0, 4}, {4, 4}, {4, 0}}};  // clockwise
  const Contour even = spread_evenly(square, 16, {2, 2});
  EXPECT_GT(signed_area(even), 0);
  EXPECT_TRUE(even.points[0].isApprox(Vec2(4, 2)));
  for (std::size_t e = 0; e < even.edges(); ++e) EXPECT_NEAR((even.end_of_edge(e) - even.points[e]).norm(), 1, 1e-12);
}

TEST(SpreadEvenly, StartsAtTheNearestDirectionWhenTheRayMisses) {
  const Contour circle = circle_contour({-10, 1}, 2, 0.5);
  const Contour even = spread_evenly(circle, 32, {0, 0});
  EXPECT_EQ(even.size(), 32U);
  EXPECT_NEAR(signed_area(even), signed_area(circle), 0.1);  // corners are cut
}

TEST(SpreadEvenly, RefusesWhatHasNoLength) {
  EXPECT_THROW(spread_evenly({{{1, 1}, {1, 1}, {1, 1}}}, 8, {0, 0}), InputError);
  EXPECT_THROW(spread_evenly({{{0, 0}, {1, 0}, {0, 1}}, false}, 8, {0, 0}), InputError);
  EXPECT_THROW(spread_evenly({{{0, 0}, {1, 0}, {0, 1}}}, 2, {0, 0}), OptionError);
  EXPECT_THROW(circle_contour({0, 0}, -1, 1), OptionError);
}

}  // namespace
}  // namespace dynasurf
