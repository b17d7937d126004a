#include "dynasurf/image/edges/detail/contour_completion.hpp"

#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/image/detail/components.hpp"

#include "support/blurred_heart.hpp"
#include "support/edge_images.hpp"

namespace dynasurf::image {
namespace {

using test::image_of;

Slice slice_of_image(const Image& m) {
  Slice s(m.grid.dims[0], m.grid.dims[1]);
  s.values = m.values;
  return s;
}

double angle_deg(double i, double j) { return std::atan2(j, i) * 180 / std::numbers::pi; }

TEST(DiffuseAlongContours, LeavesARadialImageAlone) {
  const Image rings = image_of(61, 61, 1, [](int i, int j, int) {
    const double r = std::hypot(i - 30, j - 30);
    return std::exp(-(r - 15) * (r - 15) / (2 * 5.0 * 5.0));
  });
  const Slice before = slice_of_image(rings), after = diffuse_along_contours(before, {.steps = 100});
  // Away from the centre, where tangents turn faster than their window, and from the sides.
  for (int j = 4; j < 57; ++j)
    for (int i = 4; i < 57; ++i)
      if (const double r = std::hypot(i - 30, j - 30); r > 8 && r < 26) {
        EXPECT_NEAR(after(i, j), before(i, j), 0.02) << i << " " << j;
      }
}

TEST(DiffuseAlongContours, NeitherMakesNorLosesHeat) {
  const Slice before = slice_of_image(test::noise_image(33, 28, 1)), after = diffuse_along_contours(before, {});
  const double sum = std::accumulate(before.values.begin(), before.values.end(), 0.0);
  EXPECT_NEAR(std::accumulate(after.values.begin(), after.values.end(), 0.0), sum, 1e-5 * sum);  // floats at the ends
  EXPECT_NE(after.values, before.values);
}

TEST(DiffuseAlongContours, StaysBetweenTheExtremes) {
  test::HeartShape h;
  h.dims[2] = 5, h.apex_slice = 0, h.base_slice = 4, h.noise = 0.1;
  const Image m = test::blurred_heart(h);
  const Slice before = slice_of(m, 2), after = diffuse_along_contours(before, {.steps = 100});
  // A stencil with the right directions cannot have positive weights only; it may overshoot by little.
  const auto [low, high] = std::minmax_element(before.values.begin(), before.values.end());
  for (const float v : after.values) {
    EXPECT_GT(v, *low - 0.03);
    EXPECT_LT(v, *high + 0.03);
  }
}

/// A ring without a sector around the direction +i.
Image open_ring(double gap_deg) {
  return image_of(51, 51, 1, [&](int i, int j, int) {
    const double r = std::hypot(i - 25, j - 25);
    return std::abs(angle_deg(i - 25, j - 25)) < gap_deg / 2 ? 0.0 : std::exp(-(r - 12) * (r - 12) / 4);
  });
}

TEST(DiffuseAlongContours, FillsASmallGapAlongTheArc) {
  // Only a small one: at the ends of the arc the gradient lies along it, and the tangents in the gap across it.
  const Slice before = slice_of_image(open_ring(15)), after = diffuse_along_contours(before, {.steps = 400});
  EXPECT_LT(before(37, 25), 0.01);
  EXPECT_GT(after(37, 25), 0.2);
  EXPECT_LT(after(32, 25), 0.5 * after(37, 25)) << "inside the arc";
  EXPECT_LT(after(42, 25), 0.5 * after(37, 25)) << "outside the arc";
}

/// Whether a walk over the four neighbours from the middle of a slice gets to its side without crossing an edge.
bool is_open(const Mask& edges) {
  const int width = edges.grid.dims[0], height = edges.grid.dims[1];
  Mask seen(edges.grid);
  std::vector<Pixel> walk{{width / 2, height / 2}};
  for (std::size_t n = 0; n < walk.size(); ++n) {
    const Pixel p = walk[n];
    if (p.i == 0 || p.j == 0 || p.i == width - 1 || p.j == height - 1) return true;
    for (const Pixel q : {Pixel{p.i + 1, p.j}, Pixel{p.i - 1, p.j}, Pixel{p.i, p.j + 1}, Pixel{p.i, p.j - 1}})
      if (!edges(q.i, q.j, 0) && !seen(q.i, q.j, 0)) seen(q.i, q.j, 0) = 1, walk.push_back(q);
  }
  return false;
}

/// A disc of radius 11.5 whose rim fades over `gap` degrees towards +i: there the surroundings are nearly as bright.
Image faded_disc(double gap_deg) {
  return image_of(61, 61, 1, [&](int i, int j, int) {
    const double r = std::hypot(i - 30, j - 30), a = std::abs(angle_deg(i - 30, j - 30));
    const double contrast = std::clamp(0.28 + (a - gap_deg / 2) / 60, 0.05, 1.0);
    return 1 - contrast * std::clamp(r - 11.5, 0.0, 1.0);
  });
}

TEST(ContourCompletion, ClosesAnOpenContourOnItsRing) {
  for (const double gap : {30.0, 45.0, 60.0}) {
    const Canny canny{.low = 0.28, .high = 0.5, .subpixel = true};
    const Mask open = detect_edges(faded_disc(gap), canny).edges;
    const EdgeMap map =
        detect_edges(faded_disc(gap), ContourCompletion{.steps = 600, .complete = true, .canny = canny});
    const Mask& closed = map.edges;
    EXPECT_TRUE(is_open(open)) << gap;
    EXPECT_FALSE(is_open(closed)) << gap;
    int added = 0;
    for (int j = 0; j < 61; ++j)
      for (int i = 0; i < 61; ++i)
        if (closed(i, j, 0) && !open(i, j, 0)) {
          const double x = i + map.offsets->x_px(i, j, 0) - 30, y = j + map.offsets->y_px(i, j, 0) - 30;
          EXPECT_NEAR(std::hypot(x, y), 12, 1) << gap << ": " << i << " " << j;
          ++added;
        }
    EXPECT_GT(added, 12 * gap * std::numbers::pi / 180 / 2) << gap;
  }
}

TEST(ContourCompletion, FollowsAnEllipseByItsPriorAndNotWithout) {
  // The blunt end of an ellipse of 18 x 10 px is lost: 75 degrees of its curve, where it turns most.
  const auto place = [](double angle) { return std::pair{30 + 18 * std::cos(angle), 30 + 10 * std::sin(angle)}; };
  const auto worst_px = [&](const Mask& edges) {
    double worst = 0;
    for (int n = -40; n <= 40; ++n) {
      const auto [x, y] = place(n * std::numbers::pi / 180);
      double nearest = 100;
      for (int j = 0; j < 61; ++j)
        for (int i = 0; i < 61; ++i)
          if (edges(i, j, 0)) nearest = std::min(nearest, std::hypot(i - x, j - y));
      worst = std::max(worst, nearest);
    }
    return worst;
  };
  const Image torn = image_of(61, 61, 1, [&](int i, int j, int) {
    const double level = std::hypot((i - 30) / 18.0, (j - 30) / 10.0),
                 angle = std::atan2((j - 30) / 10.0, (i - 30) / 18.0);
    const double contrast = std::clamp(0.28 + (std::abs(angle) * 180 / std::numbers::pi - 37) / 40, 0.05, 1.0);
    return 1 - contrast * std::clamp(12 * (level - 1) + 0.5, 0.0, 1.0);
  });
  ContourCompletion o{.steps = 2500, .complete = true, .canny = {.low = 0.28, .high = 0.5}};
  const double without = worst_px(detect_edges(torn, o).edges);
  o.prior = ContourPrior::ellipse;
  for (const double weight : {0.5, 0.98}) {
    o.prior_weight = weight;
    EXPECT_LT(worst_px(detect_edges(torn, o).edges), 2.1) << weight;
  }
  EXPECT_GT(without, 5);
}

TEST(ContourCompletion, WithACircleFillsAGapThatTheImageAloneLeavesOpen) {
  for (const double gap : {30.0, 60.0}) {
    const Slice before = slice_of_image(open_ring(gap));
    ContourCompletion o{.steps = 400, .prior_weight = 1};
    const Conic circle{1, 0, 1, -50, -50};  // about (25, 25)
    const Slice alone = diffuse_along_contours(before, o), led = diffuse_along_contours(before, o, circle);
    EXPECT_LT(alone(37, 25), 0.1) << gap;
    EXPECT_GT(led(37, 25), 0.4) << gap;
    EXPECT_LT(led(34, 25), 0.6 * led(37, 25)) << "inside the arc, " << gap;
    EXPECT_LT(led(40, 25), 0.6 * led(37, 25)) << "outside the arc, " << gap;
  }
}

// What the weight of the prior leaves to the contour fades away as it nears one.
TEST(ContourCompletion, FollowsItsPriorTheMoreTheHeavierItIs) {
  const Slice before = slice_of_image(open_ring(60));
  const Conic circle{1, 0, 1, -50, -50};
  const auto filled = [&](double weight) {
    return diffuse_along_contours(before, {.steps = 400, .prior_weight = weight}, circle)(37, 25);
  };
  const float half = filled(0.5), most = filled(0.98), all = filled(1);
  EXPECT_NEAR(most, all, 0.05 * all);
  EXPECT_LT(half, most);
}

Component arc(double x, double y, double a, double b, double turn, double from_deg, double to_deg) {
  Component c;
  for (double t = from_deg; t <= to_deg; t += 2) {
    const double u = a * std::cos(t * std::numbers::pi / 180), v = b * std::sin(t * std::numbers::pi / 180);
    c.pixels.push_back({static_cast<int>(std::lround(x + u * std::cos(turn) - v * std::sin(turn))),
                        static_cast<int>(std::lround(y + u * std::sin(turn) + v * std::cos(turn)))});
  }
  return c;
}

TEST(FitConics, FindsTheMiddleOfTornCirclesOfTwoWalls) {
  const std::vector<Component> walls{arc(31.5, 28, 9, 9, 0, -30, 180), arc(31.5, 28, 17, 17, 0, -60, 150)};
  const auto circle = fit_conics(walls, {.prior = ContourPrior::circle});
  ASSERT_TRUE(circle);
  EXPECT_NEAR(circle->middle()[0], 31.5, 0.3);  // pixels are rounded
  EXPECT_NEAR(circle->middle()[1], 28, 0.3);
  const auto fixed = fit_conics(walls, {.prior = ContourPrior::circle, .prior_x_px = 3, .prior_y_px = 4});
  EXPECT_EQ(fixed->middle(), Eigen::Vector2d(3, 4));
}

TEST(FitConics, FindsTheAxesOfAnEllipse) {
  const double turn = 0.4;
  const auto q =
      fit_conics(std::vector<Component>{arc(40, 30, 24, 12, turn, -100, 170)}, {.prior = ContourPrior::ellipse});
  ASSERT_TRUE(q);
  EXPECT_NEAR(q->middle()[0], 40, 0.5);
  EXPECT_NEAR(q->middle()[1], 30, 0.5);
  EXPECT_NEAR(0.5 * std::atan2(q->b, q->a - q->c), turn - std::numbers::pi / 2, 0.05);  // of the steeper axis
  const double half = (q->a + q->c) / 2, difference = std::hypot((q->a - q->c) / 2, q->b / 2);
  EXPECT_NEAR(std::sqrt((half + difference) / (half - difference)), 2, 0.1);
}

TEST(FitConics, GiveNothingForALineOrTooLittle) {
  const ContourCompletion ellipse{.prior = ContourPrior::ellipse};
  EXPECT_FALSE(fit_conics({}, ellipse));
  Component line;
  for (int i = 0; i < 30; ++i) line.pixels.push_back({i, 7});
  EXPECT_FALSE(fit_conics(std::vector{line}, ellipse));
}

TEST(ContourCompletion, WithoutStepsIsCanny) {
  const Image m = test::noise_image(30, 30, 2);
  EXPECT_EQ(detect_edges(m, ContourCompletion{.steps = 0}).edges.values, detect_edges(m, Canny{}).edges.values);
}

TEST(ContourCompletion, RefusesAStepThatMayBlowUp) {
  EXPECT_THROW(detect_edges(test::noise_image(8, 8, 1), ContourCompletion{.step = 0.3}), OptionError);
  EXPECT_THROW(detect_edges(test::noise_image(8, 8, 1), ContourCompletion{.prior_x_px = 3}), OptionError);
}

}  // namespace
}  // namespace dynasurf::image
