#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/image/components.hpp"
#include "dynasurf/image/edges.hpp"

#include "support/blurred_heart.hpp"

namespace dynasurf {
namespace {

using test::quarter_turn;
using test::shifted;

Image image_of(int width, int height, int depth, const auto& value) {
  Grid g;
  g.dims = {width, height, depth};
  Image m(g);
  for (int k = 0; k < depth; ++k)
    for (int j = 0; j < height; ++j)
      for (int i = 0; i < width; ++i) m(i, j, k) = static_cast<float>(value(i, j, k));
  return m;
}

Image noise(int width, int height, int depth) {
  std::mt19937_64 random(7);
  return image_of(width, height, depth, [&](int, int, int) { return static_cast<double>(random() % 1000) / 999; });
}

std::size_t count(const Mask& m) {
  return static_cast<std::size_t>(std::count_if(m.values.begin(), m.values.end(), [](auto v) { return v != 0; }));
}

TEST(Canny, MarksAStepWithALineOfOnePixel) {
  const Image step = image_of(32, 20, 1, [](int i, int, int) { return i < 16 ? 0 : 1; });  // between columns 15 and 16
  const Mask edges = detect_edges(step, Canny{}).edges;
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 32; ++i) EXPECT_EQ(edges(i, j, 0) != 0, i == 16) << i << " " << j;
}

TEST(Canny, TellsTheSlopeOfARamp) {
  const Image ramp = image_of(12, 12, 1, [](int i, int j, int) { return 0.03 * i + 0.04 * j; });
  const Image gradient = detect_edges(ramp, Canny{.sigma_px = 1}).gradient;
  // Beyond the reach of the replicated border (3 px of Gaussian, 1 of the difference) the slope is exact to float.
  for (int j = 4; j < 8; ++j)
    for (int i = 4; i < 8; ++i) EXPECT_NEAR(gradient(i, j, 0), 0.05, 1e-6);
}

TEST(Canny, DrawsAClosedCircleAroundADisc) {
  for (const double radius : {5.0, 8.5, 14.0}) {
    const auto cover = [&](int i, int j, int) {  // partial pixels on the rim
      return std::clamp(radius - std::hypot(i - 24, j - 24) + 0.5, 0.0, 1.0);
    };
    const Image disc = image_of(48, 48, 1, cover);
    const auto edges = components_of_slice(detect_edges(disc, Canny{.sigma_px = 1, .low = 0.2, .high = 0.5}).edges, 0);
    ASSERT_EQ(edges.size(), 1U) << radius;
    double sum = 0;
    std::vector<bool> sector(16, false);
    for (const Pixel& p : edges[0].pixels) {
      sum += std::hypot(p.i - 24, p.j - 24);
      sector[static_cast<std::size_t>((std::atan2(p.j - 24, p.i - 24) / std::numbers::pi + 1) * 7.999)] = true;
    }
    EXPECT_NEAR(sum / static_cast<double>(edges[0].pixels.size()), radius, 0.5) << radius;
    EXPECT_THAT(sector, testing::Each(true)) << radius;
  }
}

TEST(Canny, FindsNothingInAConstantImage) {
  for (const double value : {0.0, 0.3, 1.0}) {
    const EdgeMap map = detect_edges(image_of(9, 7, 3, [&](int, int, int) { return value; }), Canny{});
    EXPECT_EQ(count(map.edges), 0U);
    ASSERT_EQ(map.notes.size(), 1U);
    EXPECT_EQ(map.notes[0].code, "edges.flat");
  }
}

TEST(Canny, KeepsWeakPixelsOnlyWhereTheyHangOnStrongOnes) {
  // Two vertical steps: the left one fades from 1 to 0.4 down the rows, the right one is 0.4 all the way.
  const Image steps = image_of(40, 40, 1, [](int i, int j, int) {
    const double left = 1 - 0.6 * j / 39;
    return i < 10 ? 0 : i < 25 ? left : left + 0.4;
  });
  const Mask edges = detect_edges(steps, Canny{.sigma_px = 1, .low = 0.3, .high = 0.7}).edges;
  for (int j = 2; j < 38; ++j) {
    EXPECT_NE(edges(10, j, 0), 0) << j;
    EXPECT_EQ(edges(25, j, 0), 0) << j;
  }
}

TEST(Canny, MeasuresAgainstTheVolumeOrTheSlice) {
  const Image two = image_of(20, 20, 2, [](int i, int, int k) { return i < 10 ? 0 : k == 0 ? 1.0 : 0.25; });
  const Mask volume = detect_edges(two, Canny{.low = 0.3, .high = 0.7}).edges;
  const Mask slice =
      detect_edges(two, Canny{.low = 0.3, .high = 0.7, .threshold = CannyThreshold::max_fraction_slice}).edges;
  EXPECT_NE(volume(10, 9, 0), 0);
  EXPECT_EQ(volume(10, 9, 1), 0);
  EXPECT_NE(slice(10, 9, 1), 0);
}

TEST(Canny, PercentileTakesTheQuantileOfTheRidges) {
  const Image m = noise(64, 64, 3);
  const auto kept = [&](double quantile) {
    Canny o{.low = quantile, .high = quantile, .threshold = CannyThreshold::percentile};
    return static_cast<double>(count(detect_edges(m, o).edges));
  };
  const double all = kept(0);
  ASSERT_GT(all, 500);
  // At quantile 1 only the strongest ridge pixel starts; what hangs on it above low = 1 x high is itself.
  EXPECT_EQ(kept(1), 1);
  EXPECT_LT(kept(0.9), all);
  EXPECT_GE(kept(0.9), 0.1 * all - 1);
}

TEST(Canny, TurnsWithTheImage) {
  const Image m = noise(40, 33, 3);
  for (const Canny& o :
       {Canny{}, Canny{.sigma_px = 0, .low = 0.2, .high = 0.4}, Canny{.sigma_px = 0.8, .low = 0.1, .high = 0.9}})
    EXPECT_EQ(detect_edges(quarter_turn(m), o).edges.values, quarter_turn(detect_edges(m, o).edges).values);
}

TEST(Canny, TurnsWithASymmetricImageFullOfTies) {
  const Image rings =
      image_of(41, 41, 1, [](int i, int j, int) { return static_cast<int>(std::hypot(i - 20, j - 20) / 4) % 2; });
  const Mask edges = detect_edges(rings, Canny{.sigma_px = 0.7, .low = 0.1, .high = 0.3}).edges;
  ASSERT_GT(count(edges), 100U);
  EXPECT_EQ(edges.values, quarter_turn(edges).values);
}

TEST(Canny, MovesWithTheImage) {
  test::HeartShape h;
  h.dims[2] = 12, h.base_slice = 10, h.apex_slice = 2;
  const Image m = test::blurred_heart(h);
  // The sides are the background up to rounding; what enters is background too.
  EXPECT_EQ(detect_edges(shifted(m, 5, -3), Canny{}).edges.values,
            shifted(detect_edges(m, Canny{}).edges, 5, -3).values);
}

TEST(Canny, IgnoresContrast) {
  const Image m = noise(30, 30, 2);
  for (const float factor : {8.0F, 0.37F, 113.0F}) {
    Image scaled = m;
    for (float& v : scaled.values) v *= factor;
    EXPECT_EQ(detect_edges(scaled, Canny{}).edges.values, detect_edges(m, Canny{}).edges.values) << factor;
  }
}

TEST(Canny, NeverGainsPixelsFromAHigherThreshold) {
  const Image m = noise(50, 50, 2);
  for (const auto mode : {CannyThreshold::max_fraction, CannyThreshold::max_fraction_slice}) {
    Mask before = detect_edges(m, Canny{.low = 0.1, .high = 0.1, .threshold = mode}).edges;
    for (const double high : {0.2, 0.3, 0.5, 0.7, 0.9, 1.0}) {
      const Mask now = detect_edges(m, Canny{.low = 0.1, .high = high, .threshold = mode}).edges;
      for (std::size_t n = 0; n < now.values.size(); ++n) EXPECT_LE(now.values[n] != 0, before.values[n] != 0);
      EXPECT_LT(count(now), count(before));
      before = now;
    }
  }
}

TEST(Canny, GivesTheSameBytesForAnyNumberOfThreads) {
  const Image m = noise(64, 64, 23);
  EdgeMap reference;
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    const EdgeMap map = detect_edges(m, Canny{});
    if (threads == 1) reference = map;
    EXPECT_EQ(map.edges.values, reference.edges.values) << threads;
    EXPECT_EQ(map.gradient.values, reference.gradient.values) << threads;
  }
}

TEST(Canny, TakesTheSmallestImages) {
  for (const Index3& d : {Index3{1, 1, 1}, Index3{1, 9, 2}, Index3{9, 1, 2}, Index3{2, 2, 1}, Index3{0, 0, 0}}) {
    const EdgeMap map =
        detect_edges(image_of(d[0], d[1], d[2], [](int i, int j, int) { return i + j; }), Canny{.sigma_px = 5});
    EXPECT_EQ(map.edges.values.size(), map.edges.grid.size());
  }
}

TEST(Canny, RefusesWhatMakesNoSense) {
  const Image m = noise(8, 8, 1);
  EXPECT_THROW(detect_edges(m, Canny{.low = 0.8, .high = 0.3}), OptionError);
  EXPECT_THROW(detect_edges(m, Canny{.sigma_px = -1}), OptionError);
  EXPECT_THROW(detect_edges(m, Canny{.high = std::numeric_limits<double>::quiet_NaN()}), OptionError);
  Image broken = m;
  broken.values[5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(detect_edges(broken, Canny{}), InputError);
}

TEST(Canny, IsReachedThroughTheRegistry) {
  const Image m = noise(16, 16, 1);
  EXPECT_EQ(detect_edges(m, EdgeOptions{Canny{.sigma_px = 1}}).edges.values,
            detect_edges(m, Canny{.sigma_px = 1}).edges.values);
  EXPECT_EQ(word_of(CannyThreshold::percentile), "percentile");
}

}  // namespace
}  // namespace dynasurf
