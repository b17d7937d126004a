#include "dynasurf/image/intensity.hpp"

#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/image/detail/cover.hpp"

#include "support/edge_images.hpp"

namespace dynasurf::image {
namespace {

Image line(std::vector<float> values) {
  Image m;
  m.grid.dims = {static_cast<int>(values.size()), 1, 1};
  m.values = std::move(values);
  return m;
}

TEST(Normalise, MakesTheMaximumExactlyOne) {
  Notes notes;
  const Image once = normalise(line({3, -1, 7, 0.1F}), notes);
  EXPECT_EQ(once.values[2], 1.0F);
  EXPECT_FLOAT_EQ(once.values[1], -1.0F / 7);
  EXPECT_EQ(normalise(once, notes).values, once.values);  // idempotent
  EXPECT_TRUE(notes.empty());
}

TEST(Normalise, LeavesAVolumeWithoutPositiveValuesAndSaysSo) {
  for (const auto& values : {std::vector<float>{0, 0}, std::vector<float>{-2, -1}, std::vector<float>{}}) {
    Notes notes;
    EXPECT_EQ(normalise(line(values), notes).values, values);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_EQ(notes[0].code, "normalise.empty");
  }
}

TEST(StretchToRange, MakesTheLeastOfAllImagesZeroAndTheLargestOne) {
  Notes notes;
  std::vector<Image> gates{line({3, -1}), line({7, 1})};
  stretch_to_range(gates, notes);
  EXPECT_THAT(gates[0].values, testing::ElementsAre(0.5F, 0.0F));
  EXPECT_THAT(gates[1].values, testing::ElementsAre(1.0F, 0.25F));
  const std::vector<Image> once = gates;
  stretch_to_range(gates, notes);
  EXPECT_EQ(gates[0].values, once[0].values);  // idempotent
  EXPECT_EQ(gates[1].values, once[1].values);
  EXPECT_TRUE(notes.empty());
}

TEST(StretchToRange, LeavesDataOfOneValueAndSaysSo) {
  for (std::vector<Image> flat : {std::vector<Image>{line({2, 2}), line({2})}, std::vector<Image>{}}) {
    Notes notes;
    const std::vector<Image> before = flat;
    stretch_to_range(flat, notes);
    for (std::size_t g = 0; g < flat.size(); ++g) EXPECT_EQ(flat[g].values, before[g].values);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_EQ(notes[0].code, "normalise.flat");
  }
}

TEST(SuppressNoise, ZeroesWhatLiesBelowAShareOfTheMaximum) {
  EXPECT_THAT(suppress_noise(line({10, 1.9F, 2, -3}), 0.2).values, testing::ElementsAre(10, 0, 2, 0));
  EXPECT_THAT(suppress_noise(line({10, -3}), 0).values, testing::ElementsAre(10, -3));
  EXPECT_THROW(suppress_noise(line({1}), 1.5), OptionError);
}

TEST(ThresholdAt, IsOneEverywhereAtZeroAndOnlyLosesFromThere) {
  const Image m = test::noise_image(12, 10, 2);
  EXPECT_THAT(threshold_at(m, 0).values, testing::Each(1.0F));
  std::vector<float> before = threshold_at(m, 0).values;
  for (const double level : {0.2, 0.5, 0.9, 1.1}) {
    const std::vector<float> now = threshold_at(m, level).values;
    for (std::size_t n = 0; n < now.size(); ++n) EXPECT_LE(now[n], before[n]);
    EXPECT_NE(now, before);
    before = now;
  }
  EXPECT_THAT(threshold_at(line({0.5F, 0.49F, 0.6F}), 0.5).values, testing::ElementsAre(1, 0, 1));
}

TEST(DoubleResolution, KeepsConstantsAndPlaces) {
  Image m = test::image_of(5, 4, 3, [](int, int, int) { return 0.7; });
  m.grid.spacing = {2, 2, 4}, m.grid.origin = {10, 20, 30};
  for (const auto mask : {DoublingMask::three, DoublingMask::single}) {
    const Image twice = double_resolution(m, mask);
    EXPECT_EQ(twice.grid.dims, (Index3{10, 8, 6}));
    EXPECT_EQ(twice.grid.spacing, Vec3(1, 1, 2));
    EXPECT_EQ(twice.grid.origin, Vec3(9.5, 19.5, 29));
    for (const float v : twice.values) EXPECT_FLOAT_EQ(v, 0.7F);
  }
}

TEST(DoubleResolution, KeepsRampsWithThreeNeighboursAndNotWithOne) {
  const auto ramp = [](double x, double y, double z) { return 0.3 * x - 0.2 * y + 0.7 * z; };
  const Image m = test::image_of(8, 8, 8, ramp);
  const Image three = double_resolution(m), single = double_resolution(m, DoublingMask::single);
  double worst = 0;
  for (int k = 2; k < 14; ++k)
    for (int j = 2; j < 14; ++j)
      for (int i = 2; i < 14; ++i) {
        const double exact = ramp(i / 2.0 - 0.25, j / 2.0 - 0.25, k / 2.0 - 0.25);
        EXPECT_NEAR(three(i, j, k), exact, 1e-5);
        worst = std::max(worst, std::abs(single(i, j, k) - exact));
      }
  EXPECT_GT(worst, 0.05);
}

TEST(DoubleResolution, KeepsTheMean) {
  Image m = test::noise_image(16, 16, 6);
  for (int k = 0; k < 6; ++k)  // nothing at the sides, where neighbours are replicated
    for (int j = 0; j < 16; ++j)
      for (int i = 0; i < 16; ++i)
        if (std::min({i, j, k, 15 - i, 15 - j, 5 - k}) == 0) m(i, j, k) = 0;
  const auto mean = [](const Image& v) {
    return std::accumulate(v.values.begin(), v.values.end(), 0.0) / static_cast<double>(v.values.size());
  };
  for (const auto mask : {DoublingMask::three, DoublingMask::single})
    EXPECT_NEAR(mean(double_resolution(m, mask)), mean(m), 1e-6);
}

/// Largest difference of neighbouring pixels.
double steepest(const Image& m) {
  double most = 0;
  for (int j = 0; j < m.grid.dims[1]; ++j)
    for (int i = 0; i < m.grid.dims[0]; ++i)
      most = std::max<double>(
          {most, std::abs(m.clamped(i + 1, j, 0) - m(i, j, 0)), std::abs(m.clamped(i, j + 1, 0) - m(i, j, 0))});
  return most;
}

TEST(CutProperty, MakesAnEdgeOfTheCircleThatTheSoftCutHalves) {
  const Image flat = test::image_of(41, 41, 1, [](int, int, int) { return 1; });
  const Image hard = cut_property(flat, {.x_px = 20, .y_px = 20, .radius_px = 12.3});
  const Image soft = cut_property(flat, {.x_px = 20, .y_px = 20, .radius_px = 12.3, .soft = true});
  for (int j = 0; j < 41; ++j)
    for (int i = 0; i < 41; ++i) {
      const double r = std::hypot(i - 20, j - 20);
      EXPECT_EQ(hard(i, j, 0), r <= 12.3 ? 1 : 0);
      if (std::abs(r - 12.3) > 2) {
        EXPECT_EQ(soft(i, j, 0), hard(i, j, 0));
      }
    }
  EXPECT_GE(steepest(hard), 2 * steepest(soft));
}

TEST(CoverDisc, AddsADiscOnTopOfTheSolid) {
  Grid g;
  g.dims = {21, 21, 5}, g.spacing = {2, 2, 3};
  Mask solid(g);
  for (int k = 0; k < 3; ++k)
    for (int j = 6; j <= 14; ++j)
      for (int i = 4; i <= 12; ++i) solid(i, j, k) = 1;
  const Mask disc = cover_disc(solid, 6.1);
  std::size_t expected = 0;
  for (int j = 0; j < 21; ++j)
    for (int i = 0; i < 21; ++i) {
      const bool inside = std::hypot(2 * (i - 8), 2 * (j - 10)) <= 6.1;
      expected += inside;
      EXPECT_EQ(disc(i, j, 3) != 0, inside);
      EXPECT_EQ(disc(i, j, 2), 0);
    }
  EXPECT_EQ(test::count_set(unite(solid, disc)), test::count_set(solid) + expected);
}

TEST(Prepare, DoesNothingUnasked) {
  const Image m = test::noise_image(12, 10, 2);
  EXPECT_EQ(prepare(m, {}).values, m.values);
}

TEST(Prepare, CutsThenDoublesThenThresholds) {
  Image m = test::image_of(12, 12, 2, [](int i, int, int) { return 2.0 * i; });
  Preparation o;
  o.cut_radius_px = 4, o.doubling = Preparation::Doubling::three, o.threshold = 0.5;
  const Image twice = double_resolution(cut_property(m, {.x_px = 5.5, .y_px = 5.5, .radius_px = 4}));
  const float most = *std::max_element(twice.values.begin(), twice.values.end());
  EXPECT_EQ(prepare(m, o).values, threshold_at(twice, 0.5 * most).values);
}

}  // namespace
}  // namespace dynasurf::image
