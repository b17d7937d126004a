#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/image/detail/components.hpp"
#include "dynasurf/image/edges.hpp"

#include "support/blurred_heart.hpp"
#include "support/edge_images.hpp"

namespace dynasurf::image {
namespace {

using test::quarter_turn;
using test::shifted;

using test::image_of;

Image noise(int width, int height, int depth) { return test::noise_image(width, height, depth); }
std::size_t count(const Mask& m) { return test::count_set(m); }

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
}  // namespace dynasurf::image
