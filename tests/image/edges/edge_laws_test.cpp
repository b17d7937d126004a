// The laws of all edge detectors. A new one comes under them by its place in EdgeOptions.
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/image/edges.hpp"

#include "support/blurred_heart.hpp"
#include "support/edge_images.hpp"
#include "support/method_types.hpp"

namespace dynasurf::image {
namespace {

using test::count_set;
using test::image_of;
using test::quarter_turn;
using test::shifted;

template <class Options>
class EdgeLaws : public testing::Test {
 public:
  /// The detector as it is, and in the settings that take another way through it.
  std::vector<Options> variants() {
    std::vector<Options> all{Options{}};
    if constexpr (requires(Options o) { o.measure; })
      for (const auto m : {GradientMeasure::magnitude, GradientMeasure::laplacian, GradientMeasure::roberts})
        all.push_back({.measure = m});
    if constexpr (requires(Options o) { o.thin; })
      for (const Options& o : std::vector<Options>(all)) all.push_back(o), all.back().thin = true;
    if constexpr (std::is_same_v<Options, Canny>)
      for (const auto t : {CannyThreshold::max_fraction_slice, CannyThreshold::percentile}) {
        const bool quantile = t == CannyThreshold::percentile;
        all.push_back({.sigma_px = 1.8, .low = quantile ? 0.3 : 0.15, .high = quantile ? 0.4 : 0.3, .threshold = t});
      }
    if constexpr (requires(Options o) { o.complete; }) all.push_back({.complete = true});
    if constexpr (requires(Options o) { o.canny; }) {
      for (Options& o : all) o.canny.subpixel = true;
    } else {
      for (Options& o : all) o.subpixel = true;
    }
    return all;
  }
};

TYPED_TEST_SUITE(EdgeLaws, test::MethodTypes<EdgeOptions>::type, test::MethodName);

Image small_heart(double noise) {
  test::HeartShape h;
  h.dims = {64, 64, 8}, h.apex_slice = 1, h.base_slice = 6, h.noise = noise;
  return test::blurred_heart(h);
}

TYPED_TEST(EdgeLaws, MoveWithTheImage) {
  const Image m = small_heart(0);  // what enters on one side is the background
  for (const TypeParam& o : this->variants()) {
    const Mask at = detect_edges(m, o).edges;
    ASSERT_GT(count_set(at), 300U);
    EXPECT_EQ(detect_edges(shifted(m, 4, -3), o).edges.values, shifted(at, 4, -3).values);
  }
}

TYPED_TEST(EdgeLaws, TurnWithTheImage) {
  for (const Image& m : {small_heart(0.05), test::noise_image(40, 33, 2)})
    for (const TypeParam& o : this->variants()) {
      const EdgeMap at = detect_edges(m, o), there = detect_edges(quarter_turn(m), o);
      ASSERT_GT(count_set(at.edges), 100U);
      EXPECT_EQ(there.edges.values, quarter_turn(at.edges).values);
      // (x, y) turns to (-y, x). Where sums run in another order their last bits differ; a hundredth of a pixel is
      // far below what an offset can tell.
      const Image x = quarter_turn(at.offsets->x_px), y = quarter_turn(at.offsets->y_px);
      for (std::size_t n = 0; n < x.values.size(); ++n) {
        EXPECT_NEAR(there.offsets->x_px.values[n], -y.values[n], 0.01);
        EXPECT_NEAR(there.offsets->y_px.values[n], x.values[n], 0.01);
      }
    }
}

TYPED_TEST(EdgeLaws, IgnoreTheContrastOfTheVolume) {
  const Image m = small_heart(0.05);
  for (const float factor : {8.0F, 0.37F, 113.0F}) {
    Image scaled = m;
    for (float& v : scaled.values) v *= factor;
    for (const TypeParam& o : this->variants())
      EXPECT_EQ(detect_edges(scaled, o).edges.values, detect_edges(m, o).edges.values) << factor;
  }
}

TYPED_TEST(EdgeLaws, GiveTheSameBytesForAnyNumberOfThreads) {
  const Image m = small_heart(0.1);
  for (const TypeParam& o : this->variants()) {
    EdgeMap reference;
    for (const int threads : {1, 2, 4}) {
      const ThreadLimit limit(threads);
      const EdgeMap map = detect_edges(m, o);
      if (threads == 1) reference = map;
      EXPECT_EQ(map.edges.values, reference.edges.values) << threads;
      EXPECT_EQ(map.gradient.values, reference.gradient.values) << threads;
      EXPECT_EQ(map.offsets->x_px.values, reference.offsets->x_px.values) << threads;
    }
  }
}

TYPED_TEST(EdgeLaws, FindNothingInAConstantImage) {
  for (const double value : {0.0, 0.3, 1.0})
    for (const TypeParam& o : this->variants()) {
      const EdgeMap map = detect_edges(image_of(9, 7, 3, [&](int, int, int) { return value; }), o);
      EXPECT_EQ(count_set(map.edges), 0U);
      ASSERT_EQ(map.notes.size(), 1U);
      EXPECT_EQ(map.notes[0].code, "edges.flat");
    }
}

TYPED_TEST(EdgeLaws, TakeTheSmallestImages) {
  for (const Index3& d : {Index3{1, 1, 1}, Index3{1, 9, 2}, Index3{9, 1, 2}, Index3{2, 2, 1}, Index3{0, 0, 0}})
    for (const TypeParam& o : this->variants()) {
      const EdgeMap map = detect_edges(image_of(d[0], d[1], d[2], [](int i, int j, int) { return i + j; }), o);
      EXPECT_EQ(map.edges.values.size(), map.edges.grid.size());
    }
}

TYPED_TEST(EdgeLaws, FindTheRimOfADisc) {
  // Offsets bring the rim nearer to the truth than pixels can be; an unthinned band has its middle there.
  for (const double radius : {8.3, 12.0, 14.6}) {
    const Image disc = test::disc_image(48, 23.5, 24.2, radius);
    for (const TypeParam& o : this->variants()) {
      const EdgeMap map = detect_edges(disc, o);
      double sum = 0, count = 0;
      std::vector<bool> sector(16, false);
      for (int j = 0; j < 48; ++j)
        for (int i = 0; i < 48; ++i) {
          if (!map.edges(i, j, 0)) continue;
          const double x = i + map.offsets->x_px(i, j, 0) - 23.5, y = j + map.offsets->y_px(i, j, 0) - 24.2;
          sum += std::hypot(x, y), count += 1;
          sector[static_cast<std::size_t>((std::atan2(y, x) / std::numbers::pi + 1) * 7.999)] = true;
        }
      EXPECT_NEAR(sum / count, radius, 0.35) << radius;
      EXPECT_THAT(sector, testing::Each(true)) << radius;
    }
  }
}

TYPED_TEST(EdgeLaws, KeepOffsetsInsideTheirPixelsAndOffWhenNotAsked) {
  for (const TypeParam& o : this->variants()) {
    const EdgeMap map = detect_edges(small_heart(0.1), o);
    ASSERT_TRUE(map.offsets);
    double moved = 0;
    for (std::size_t n = 0; n < map.edges.values.size(); ++n) {
      const float x = map.offsets->x_px.values[n], y = map.offsets->y_px.values[n];
      EXPECT_LE(std::max(std::abs(x), std::abs(y)), 0.5F);
      if (!map.edges.values[n]) {
        EXPECT_EQ(x, 0);
      }
      moved += x != 0 || y != 0;
    }
    EXPECT_GT(moved, 0);
  }
  EXPECT_FALSE(detect_edges(small_heart(0), TypeParam{}).offsets);
}

TYPED_TEST(EdgeLaws, AreReachedThroughTheRegistry) {
  const Image m = small_heart(0.05);
  EXPECT_EQ(detect_edges(m, EdgeOptions{TypeParam{}}).edges.values, detect_edges(m, TypeParam{}).edges.values);
}

TYPED_TEST(EdgeLaws, RefuseValuesThatAreNotFinite) {
  Image broken = test::noise_image(8, 8, 1);
  broken.values[5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(detect_edges(broken, TypeParam{}), InputError);
}

}  // namespace
}  // namespace dynasurf::image
