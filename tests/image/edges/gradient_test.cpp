#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/image/edges.hpp"

#include "support/edge_images.hpp"

namespace dynasurf::image {
namespace {

using test::count_set;
using test::image_of;

GradientEdges with(GradientMeasure m) { return {.measure = m}; }

TEST(GradientEdges, MeasureARampExactly) {
  Image ramp = image_of(9, 9, 1, [](int i, int j, int) { return 0.25 * i + 0.5 * j; });
  ramp.grid.spacing = {0.5, 2, 1};  // slopes of 0.5 and 0.25 per mm
  const auto at = [&](GradientMeasure m) { return detect_edges(ramp, with(m)).gradient(4, 4, 0); };
  EXPECT_EQ(at(GradientMeasure::squared), 0.5F * 0.5F + 0.25F * 0.25F);
  EXPECT_FLOAT_EQ(at(GradientMeasure::magnitude), std::sqrt(0.3125F));
  EXPECT_EQ(at(GradientMeasure::laplacian), 0);
}

TEST(GradientEdges, MeasureTheCurvatureOfAParabola) {
  const Image parabola = image_of(9, 9, 1, [](int i, int j, int) { return i * i + 3 * j * j; });
  EXPECT_EQ(detect_edges(parabola, with(GradientMeasure::laplacian)).gradient(4, 4, 0), 2 + 6);
}

TEST(GradientEdges, RobertsCrossTakesTheDifferencesOfTheDiagonals) {
  const Image ramp = image_of(9, 9, 1, [](int i, int j, int) { return 0.3 * i + 0.4 * j; });
  EXPECT_FLOAT_EQ(detect_edges(ramp, with(GradientMeasure::roberts)).gradient(4, 4, 0), 0.5F);
  // One bright pixel is the end of a diagonal of each of the four squares around it, and of no others.
  const Image dot = image_of(9, 9, 1, [](int i, int j, int) { return i == 4 && j == 4; });
  const Mask edges = detect_edges(dot, with(GradientMeasure::roberts)).edges;
  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 9; ++i) EXPECT_EQ(edges(i, j, 0) != 0, std::abs(i - 4) <= 1 && std::abs(j - 4) <= 1);
}

TEST(GradientEdges, ThinToOneLineOnTheBrightSideOfAStep) {
  const Image step = image_of(16, 8, 1, [](int i, int, int) { return i < 8 ? 0 : 1; });
  for (const auto m :
       {GradientMeasure::squared, GradientMeasure::magnitude, GradientMeasure::laplacian, GradientMeasure::roberts}) {
    const Mask thin = detect_edges(step, GradientEdges{.measure = m, .thin = true}).edges;
    const Mask thick = detect_edges(step, GradientEdges{.measure = m}).edges;
    for (int i = 0; i < 16; ++i) {
      EXPECT_EQ(thin(i, 4, 0) != 0, i == 8) << word_of(m) << i;
      EXPECT_EQ(thick(i, 4, 0) != 0, i == 7 || i == 8) << word_of(m) << i;
    }
  }
}

TEST(GradientEdges, LoseWhatIsBelowTheThreshold) {
  const Image steps = image_of(24, 8, 1, [](int i, int, int) { return i < 8 ? 0 : i < 16 ? 1.0 : 1.4; });
  EXPECT_TRUE(
      detect_edges(steps, GradientEdges{.measure = GradientMeasure::magnitude, .threshold = 0.39}).edges(16, 4, 0));
  EXPECT_FALSE(
      detect_edges(steps, GradientEdges{.measure = GradientMeasure::magnitude, .threshold = 0.41}).edges(16, 4, 0));
  EXPECT_FALSE(detect_edges(steps, GradientEdges{.threshold = 0.2}).edges(16, 4, 0)) << "squared: 0.16 of the largest";
  EXPECT_THROW(detect_edges(steps, GradientEdges{.threshold = 2}), OptionError);
}

TEST(SobelEdges, GiveEightTimesTheSlope) {
  const Image along_x = image_of(9, 9, 1, [](int i, int, int) { return i; });
  EXPECT_EQ(detect_edges(along_x, SobelEdges{}).gradient(4, 4, 0), 8);
  const Image ramp = image_of(9, 9, 1, [](int i, int j, int) { return 3 * i + 4 * j; });
  EXPECT_EQ(detect_edges(ramp, SobelEdges{}).gradient(4, 4, 0), 40);
}

TEST(SobelEdges, WeighTheNeighboursOneTwoOne) {
  const Image dot = image_of(9, 9, 1, [](int i, int j, int) { return i == 4 && j == 4; });
  const Image g = detect_edges(dot, SobelEdges{}).gradient;
  EXPECT_EQ(g(3, 4, 0), 2);
  EXPECT_EQ(g(4, 5, 0), 2);
  EXPECT_FLOAT_EQ(g(3, 3, 0), std::sqrt(2.0F));
  EXPECT_EQ(g(4, 4, 0), 0);
}

TEST(SobelEdges, ThinToOneLine) {
  const Image step = image_of(16, 8, 1, [](int i, int, int) { return i < 8 ? 0 : 1; });
  const Mask thin = detect_edges(step, SobelEdges{.thin = true}).edges;
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 16; ++i) EXPECT_EQ(thin(i, j, 0) != 0, i == 8);
  EXPECT_EQ(count_set(detect_edges(step, SobelEdges{}).edges), 16U);
}

}  // namespace
}  // namespace dynasurf::image
