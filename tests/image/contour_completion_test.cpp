#include "dynasurf/image/edges/detail/contour_completion.hpp"

#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/image/components.hpp"

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

TEST(ContourCompletion, ClosesAnOpenContour) {
  for (const double gap : {30.0, 45.0, 60.0}) {
    // Towards +i the surroundings are nearly as bright as the disc: over `gap` degrees its rim is below the threshold.
    const Image disc = image_of(61, 61, 1, [&](int i, int j, int) {
      const double r = std::hypot(i - 30, j - 30), a = std::abs(angle_deg(i - 30, j - 30));
      const double contrast = std::clamp(0.28 + (a - gap / 2) / 60, 0.05, 1.0);
      return 1 - contrast * std::clamp(r - 11.5, 0.0, 1.0);
    });
    const Canny canny{.low = 0.28, .high = 0.5};
    const Mask open = detect_edges(disc, canny).edges;
    const Mask closed = detect_edges(disc, ContourCompletion{.steps = 600, .complete = true, .canny = canny}).edges;
    EXPECT_TRUE(is_open(open)) << gap;
    EXPECT_FALSE(is_open(closed)) << gap;
    // The bridge goes straight on from the ends before it bends, so it lies outside the arc: by 2 to 6 pixels.
    for (int j = 0; j < 61; ++j)
      for (int i = 0; i < 61; ++i)
        if (closed(i, j, 0) && !open(i, j, 0)) {
          EXPECT_NEAR(std::hypot(i - 30, j - 30), 12, 6.5) << gap;
        }
  }
}

TEST(ContourCompletion, WithoutStepsIsCanny) {
  const Image m = test::noise_image(30, 30, 2);
  EXPECT_EQ(detect_edges(m, ContourCompletion{.steps = 0}).edges.values, detect_edges(m, Canny{}).edges.values);
}

TEST(ContourCompletion, RefusesAStepThatMayBlowUp) {
  EXPECT_THROW(detect_edges(test::noise_image(8, 8, 1), ContourCompletion{.step = 0.3}), OptionError);
}

}  // namespace
}  // namespace dynasurf::image
