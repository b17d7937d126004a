#include "dynasurf/dynamics/contour/detail/curvature.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "dynasurf/dynamics/contour/contours.hpp"

namespace dynasurf::dynamics {
namespace {

std::vector<Vec2> force_on(const Contour& c, CurvatureFilter filter = CurvatureFilter::fixed) {
  return curvature_force(c, curvature_frame(c), filter);
}

double largest(const std::vector<Vec2>& forces) {
  double most = 0;
  for (const Vec2& f : forces) most = std::max(most, f.norm());
  return most;
}

Contour zigzag(double height) {
  Contour c{{}, false};
  for (int i = 0; i < 21; ++i) c.points.push_back({2.0 * i, i % 2 ? height : -height});
  return c;
}

/// A shape without any symmetry.
Contour blob() {
  Contour c;
  for (int i = 0; i < 30; ++i) {
    const double a = 2 * std::numbers::pi * i / 30;
    const double r = 10 + 2 * std::cos(3 * a) + std::sin(2 * a + 1);
    c.points.push_back(r * Vec2(std::cos(a), std::sin(a)));
  }
  return c;
}

TEST(CurvatureFrame, PointsOutwardsAndIsNegativeWhereConvex) {
  const Contour c = circle_contour({0, 0}, 7, 1.5);
  const CurvatureFrame frame = curvature_frame(c);
  const double turn = 2 * std::numbers::pi / static_cast<double>(c.size());
  for (std::size_t i = 0; i < c.size(); ++i) {
    EXPECT_TRUE(frame.radial[i].isApprox(c.points[i] / 7, 1e-12));
    EXPECT_NEAR(frame.k[i], -2 * std::sin(turn / 2), 1e-12);
  }
}

TEST(CurvatureForce, VanishesOnRegularPolygonsOfAnySize) {
  for (const double radius : {1.0, 5.0, 40.0})
    for (const auto filter : {CurvatureFilter::fixed, CurvatureFilter::adaptive})
      EXPECT_LT(largest(force_on(circle_contour({3, 4}, radius, 1), filter)), 1e-12);
}

TEST(CurvatureForce, DoublesAnAlternatingCurvature) {
  const Contour c = zigzag(0.5);
  const CurvatureFrame frame = curvature_frame(c);
  const auto force = force_on(c);
  for (std::size_t i = 2; i + 2 < c.size(); ++i) EXPECT_NEAR(force[i].norm(), 2 * std::abs(frame.k[i]), 1e-12);
}

TEST(CurvatureForce, PullsASpikeBackFromBothSenses) {
  Contour c = circle_contour({0, 0}, 10, 2);
  c.points[4] *= 1.2;
  const Vec2 inwards = -c.points[4];
  EXPECT_GT(force_on(c)[4].dot(inwards), 0);
  const auto forward = force_on(c);
  std::reverse(c.points.begin(), c.points.end());
  auto backward = force_on(c);
  std::reverse(backward.begin(), backward.end());
  for (std::size_t i = 0; i < forward.size(); ++i) EXPECT_LT((forward[i] - backward[i]).norm(), 1e-12);
}

TEST(CurvatureForce, TurnsAndMovesWithItsContour) {
  const Contour c = blob();
  const Eigen::Rotation2Dd turn(0.7);
  Contour moved = c;
  for (Vec2& p : moved.points) p = turn * p + Vec2(11, -3);
  for (const auto filter : {CurvatureFilter::fixed, CurvatureFilter::adaptive}) {
    const auto a = force_on(c, filter), b = force_on(moved, filter);
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT((turn * a[i] - b[i]).norm(), 1e-12);
  }
}

TEST(CurvatureForce, OfTheAdaptiveFilterIgnoresUnequalEdgesOfACircle) {
  Contour c;
  for (int i = 0; i < 40; ++i) {
    const double a = 2 * std::numbers::pi * (i + 0.3 * std::sin(5.0 * i)) / 40;
    c.points.push_back(10 * Vec2(std::cos(a), std::sin(a)));
  }
  const double fixed = largest(force_on(c)), adaptive = largest(force_on(c, CurvatureFilter::adaptive));
  EXPECT_GT(fixed, 0.02);
  EXPECT_LT(adaptive, fixed / 20);  // what is left is the chord against the arc, second order in the edge
}

TEST(CurvatureForce, OfBothFiltersIsTheSameOnEqualEdges) {
  Contour c;  // an equilateral octagon with unequal angles
  Vec2 at(0, 0);
  double heading = 0;
  const double turns[] = {0.6, 1.0, 0.5, 1.04, 0.6, 1.0, 0.5, 1.04};
  for (const double turn : turns) {
    c.points.push_back(at);
    at += Vec2(std::cos(heading), std::sin(heading));
    heading += turn;
  }
  c.closed = false;
  const auto a = force_on(c), b = force_on(c, CurvatureFilter::adaptive);
  for (std::size_t i = 2; i + 2 < c.size(); ++i) EXPECT_LT((a[i] - b[i]).norm(), 1e-12) << i;
}

TEST(CurvatureForce, SurvivesReversalsAndRepeatedPoints) {
  const Contour reversal{{{0, 0}, {2, 0}, {0, 0}, {-2, 0}}, false};
  for (const Vec2& f : force_on(reversal)) EXPECT_TRUE(f.allFinite());
  Contour repeated = circle_contour({0, 0}, 10, 2);
  const auto single = force_on(repeated);
  repeated.points.insert(repeated.points.begin() + 3, repeated.points[3]);
  for (const Vec2& f : force_on(repeated)) EXPECT_TRUE(f.allFinite());
  const Contour point{{{1, 1}, {1, 1}, {1, 1}}};
  EXPECT_EQ(largest(force_on(point)), 0);
}

TEST(DiscreteContour, KeepsARegularPolygonForAThousandSteps) {
  const Contour start = circle_contour({20, 20}, 8, 2);
  DiscreteContour o;
  o.still_px = 0;  // never at rest: all steps are taken
  o.max_steps = 1000;
  const ContourResult r = evolve_contour(start, {}, o);
  EXPECT_EQ(r.steps, 1000);
  ASSERT_EQ(r.contour.size(), start.size());
  for (std::size_t i = 0; i < start.size(); ++i) EXPECT_LT((r.contour.points[i] - start.points[i]).norm(), 1e-9);
}

TEST(DiscreteContour, FlattensAZigzag) {
  DiscreteContour o;
  o.resample_every = 0;
  o.max_steps = 200;
  const ContourResult r = evolve_contour(zigzag(0.5), {}, o);
  for (std::size_t i = 8; i + 8 < r.contour.size(); ++i) EXPECT_LT(std::abs(r.contour.points[i].y()), 0.1);
}

TEST(DiscreteContour, ShortensAndWidensAHalfCircleCap) {
  // Two straight sides and round ends (thesis fig 3.12b).
  Contour c;
  for (int i = 0; i < 30; ++i) c.points.push_back({2.0 * i, -6});
  for (int i = 0; i < 10; ++i) {
    const double a = std::numbers::pi * (i / 9.0 - 0.5);
    c.points.push_back(Vec2(59, 0) + 6 * Vec2(std::cos(a), std::sin(a)));
  }
  for (int i = 29; i >= 0; --i) c.points.push_back({2.0 * i, 6});
  for (int i = 0; i < 10; ++i) {
    const double a = std::numbers::pi * (i / 9.0 + 0.5);
    c.points.push_back(Vec2(-1, 0) + 6 * Vec2(std::cos(a), std::sin(a)));
  }
  DiscreteContour o;
  o.max_steps = 60;
  const ContourResult r = evolve_contour(c, {}, o);
  double right = 0, high = 0, middle = 0;
  for (const Vec2& p : r.contour.points) {
    right = std::max(right, p.x());
    high = std::max(high, p.y());
    if (std::abs(p.x() - 29) < 1.5) middle = std::max(middle, std::abs(p.y()));
  }
  EXPECT_LT(right, 65);
  EXPECT_GT(right, 62);
  EXPECT_GT(high, 6.02);
  EXPECT_NEAR(middle, 6, 0.05);
}

}  // namespace
}  // namespace dynasurf::dynamics
