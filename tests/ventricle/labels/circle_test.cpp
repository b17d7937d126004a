#include "dynasurf/ventricle/labels/detail/circle.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "support/notes.hpp"

namespace dynasurf::ventricle {
namespace {

using test::has_code;

/// Pixels whose centres lie within half a pixel of an arc.
image::Component arc(double x, double y, double radius, double from_deg = 0, double to_deg = 360, int slice = 0) {
  image::Component c{slice, {}};
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) {
      double angle = std::atan2(j - y, i - x) * 180 / std::numbers::pi;
      if (angle < 0) angle += 360;
      if (std::abs(std::hypot(i - x, j - y) - radius) <= 0.5 && angle >= from_deg && angle <= to_deg)
        c.pixels.push_back({i, j});
    }
  return c;
}

Image black(int slices) {
  Grid g;
  g.dims = {64, 64, slices};
  return Image(g);
}

SliceEdges stack(const std::vector<image::Component>& edges, int slices) {
  SliceEdges all(static_cast<std::size_t>(slices));
  for (const image::Component& e : edges) all[static_cast<std::size_t>(e.slice)].push_back(e);
  return all;
}

TEST(FitCircle, PassesThroughThreePixels) {
  const auto c = fit_circle({{1, 0}, {0, 1}, {-1, 0}});
  ASSERT_TRUE(c);
  EXPECT_NEAR(c->x_px, 0, 1e-12);
  EXPECT_NEAR(c->y_px, 0, 1e-12);
  EXPECT_NEAR(c->radius_px, 1, 1e-12);
}

TEST(FitCircle, IsNotPulledByAnOpenArc) {
  // Half of the ring is missing. The centroid of what is left lies 7 px off; the fit stays within a pixel's fraction.
  const image::Component half = arc(30.3, 28.7, 11, 0, 200);
  const auto c = fit_circle(half.pixels);
  ASSERT_TRUE(c);
  EXPECT_NEAR(c->x_px, 30.3, 0.2);
  EXPECT_NEAR(c->y_px, 28.7, 0.2);
  EXPECT_NEAR(c->radius_px, 11, 0.2);
}

TEST(FitCircle, RefusesLinesAndPoints) {
  EXPECT_FALSE(fit_circle({}));
  EXPECT_FALSE(fit_circle({{1, 1}, {1, 1}, {1, 1}}));
  EXPECT_FALSE(fit_circle({{0, 0}, {2, 1}, {4, 2}, {6, 3}}));
}

TEST(Coverage, IsTheTurnLessTheWidestGap) {
  EXPECT_NEAR(coverage_deg({{1, 0}, {0, 1}, {-1, 0}, {0, -1}}, 0, 0), 270, 1e-9);
  EXPECT_NEAR(coverage_deg({{1, 0}, {0, 1}}, 0, 0), 90, 1e-9);
  EXPECT_EQ(coverage_deg({{1, 0}}, 0, 0), 0);
  EXPECT_NEAR(coverage_deg(arc(32, 32, 12, 0, 240).pixels, 32, 32), 240, 6);  // a pixel is 5 degrees wide there
}

TEST(CoarseCircle, IsTheLargestInTheImageUnlessDrawn) {
  Grid g;
  g.dims = {64, 40, 3};
  const Circle c = coarse_circle(g, {});
  EXPECT_EQ(c.x_px, 31.5);
  EXPECT_EQ(c.y_px, 19.5);
  EXPECT_EQ(c.radius_px, 20);
  const Circle drawn = coarse_circle(g, {.x_px = 5, .y_px = 6, .radius_px = 7});
  EXPECT_EQ(drawn.x_px + drawn.y_px + drawn.radius_px, 18);
}

TEST(Clip, CutsPixelByPixelAlongTheAxis) {
  Mask m(black(2).grid, 1);
  const Mask cut = clip(m, {10, 10, 5, 0}, 2);
  EXPECT_TRUE(cut(12, 10, 0));
  EXPECT_FALSE(cut(13, 10, 0));
  EXPECT_TRUE(cut(17, 10, 1));  // five columns further in the next slice
  EXPECT_FALSE(cut(10, 10, 1));
}

TEST(FindComponents, DropsEdgesTooSmallToBeBorders) {
  Mask m(black(1).grid);
  for (int i = 0; i < 9; ++i) m(i, 3, 0) = 2;
  for (int i = 20; i < 27; ++i) m(i, 3, 0) = 2;
  const SliceEdges found = find_components(m, 8);
  ASSERT_EQ(found[0].size(), 1U);
  EXPECT_EQ(found[0][0].pixels.size(), 9U);
  EXPECT_EQ(to_mask(found, m.grid)(4, 3, 0), 1);
}

class FindCentre : public testing::TestWithParam<bool> {};  // robust or as published

TEST_P(FindCentre, IsExactForCirclesWithOneCentre) {
  Notes notes;
  const SliceEdges edges =
      stack({arc(33, 30, 8, 0, 360, 0), arc(33, 30, 12, 0, 360, 1), arc(33, 30, 15, 0, 360, 2)}, 3);
  const Centre c = find_centre(edges, black(3), AutoCircle{.robust_fit = GetParam()}, notes);
  EXPECT_NEAR(c.x_px, 33, 1e-9);
  EXPECT_NEAR(c.y_px, 30, 1e-9);
  ASSERT_TRUE(c.local[1]);
  EXPECT_NEAR(c.local[1]->radius_px, 12, 0.2);
  EXPECT_TRUE(notes.empty());
}

TEST_P(FindCentre, IsHardlyMovedByAFarCircle) {
  Notes notes;
  std::vector<image::Component> edges;
  for (int k = 0; k < 10; ++k) edges.push_back(arc(33, 30, 10, 0, 360, k));
  edges.push_back(arc(8, 52, 6, 0, 360, 10));
  const Centre c = find_centre(stack(edges, 11), black(11), AutoCircle{.robust_fit = GetParam()}, notes);
  EXPECT_NEAR(c.x_px, 33, 0.1);
  EXPECT_NEAR(c.y_px, 30, 0.1);
}

TEST_P(FindCentre, FallsBackToTheIntensities) {
  Notes notes;
  Image image = black(2);
  image(10, 20, 0) = image(12, 20, 1) = 1;
  const Centre c = find_centre(stack({arc(30, 30, 15, 0, 60)}, 2), image, AutoCircle{.robust_fit = GetParam()}, notes);
  EXPECT_EQ(c.x_px, 11);
  EXPECT_EQ(c.y_px, 20);
  EXPECT_TRUE(has_code(notes, "circle.no_circular_edge"));
  const Centre middle = find_centre(stack({}, 2), black(2), AutoCircle{.robust_fit = GetParam()}, notes);
  EXPECT_EQ(middle.x_px, 31.5);
}

INSTANTIATE_TEST_SUITE_P(BothFits, FindCentre, testing::Bool(),
                         [](const auto& p) { return p.param ? "robust" : "thesis"; });

TEST(FindCentre, TakesArcsOnlyWithTheRobustFit) {
  const SliceEdges edges = stack({arc(33, 30, 12, 0, 250)}, 1);
  Notes thesis, robust;
  EXPECT_FALSE(find_centre(edges, black(1), AutoCircle{.robust_fit = false}, thesis).local[0]);
  const Centre c = find_centre(edges, black(1), AutoCircle{.robust_fit = true}, robust);
  ASSERT_TRUE(c.local[0]);
  EXPECT_NEAR(c.x_px, 33, 0.2);
}

TEST(FindAxis, FollowsATiltedStackPastWrongCentres) {
  Centre centre{32, 32, {}};
  for (int k = 0; k < 12; ++k) centre.local.push_back(Circle{30 + 0.5 * k, 33 - 0.25 * k, 10});
  centre.local[2] = Circle{10, 50, 9};
  centre.local[7] = std::nullopt;
  centre.local[9] = Circle{50, 50, 9};
  const Axis axis = find_axis(centre, AutoCircle{});
  EXPECT_NEAR(axis.x_at(11), 35.5, 0.2);
  EXPECT_NEAR(axis.y_at(11), 30.25, 0.2);
  const Axis upright = find_axis(centre, AutoCircle{.robust_fit = false});
  EXPECT_EQ(upright.x_at(0), 32);
  EXPECT_EQ(upright.x_at(11), 32);
}

TEST(FindWidestEdge, TakesTheOuterBorderOfTheWidestSlice) {
  Notes notes;
  const SliceEdges edges = stack(
      {arc(32, 32, 10, 0, 360, 0), arc(32, 32, 14, 0, 360, 1), arc(32, 32, 8, 0, 360, 1), arc(32, 32, 12, 0, 360, 2)},
      3);
  const WidestEdge w = find_widest_edge(edges, black(3).grid, {32, 32, 0, 0}, AutoCircle{}, notes);
  EXPECT_EQ(w.slice, 1);
  EXPECT_NEAR(w.radius_px, 14, 0.2);
  EXPECT_TRUE(notes.empty());
}

TEST(FindWidestEdge, PassesOverABlobBesideTheHeart) {
  // The far side of a gut loop lies farther from the axis than the heart's border, but is no circle around it.
  Notes notes;
  const SliceEdges edges =
      stack({arc(32, 32, 13, 0, 360, 0), arc(32, 52, 6, 0, 360, 0), arc(32, 32, 24, 60, 120, 0)}, 1);
  const WidestEdge w = find_widest_edge(edges, black(1).grid, {32, 32, 0, 0}, AutoCircle{}, notes);
  EXPECT_NEAR(w.radius_px, 13, 0.2);
}

TEST(FindWidestEdge, SaysWhenThereIsNone) {
  Notes notes;
  EXPECT_EQ(
      find_widest_edge(stack({arc(32, 32, 13, 0, 90)}, 1), black(1).grid, {32, 32, 0, 0}, AutoCircle{}, notes).slice,
      -1);
  EXPECT_TRUE(has_code(notes, "circle.no_wide_edge"));
}

}  // namespace
}  // namespace dynasurf::ventricle
