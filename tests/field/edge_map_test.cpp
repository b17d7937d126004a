#include "dynasurf/field/edge_map.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"

#include "support/edge_maps.hpp"

namespace dynasurf::field {
namespace {

using namespace test;

TEST(EdgeMap, OfAQuadraticIsItsSlope) {
  const Image image = drawn(box(9, 9, 9, {1, 2, 3}), [](const Vec3& p) { return p[2] * p[2]; });
  const Image slope = edge_map_of(image, {.of = EdgeOperator::gradient});
  const Image square = edge_map_of(image, {});
  // |d/dz z^2| = 2 |z|, 21 mm/mm at the outermost voxels, where the difference is one-sided.
  EXPECT_EQ(slope(4, 4, 4), 0);
  EXPECT_NEAR(slope(4, 4, 6), 12 / 21.0, 1e-6);
  EXPECT_NEAR(square(4, 4, 6), 144 / 441.0, 1e-6);
  EXPECT_EQ(slope(0, 0, 8), 1);
}

TEST(EdgeMap, OfAWallIsHighestOnItsTwoFacesAndOfItsIntensityInTheMiddle) {
  const Image wall =
      drawn(box(41, 3, 3), [](const Vec3& p) { return 1 / (1 + std::exp(-p[0] - 8)) - 1 / (1 + std::exp(-p[0] + 8)); });
  const Image faces = edge_map_of(wall, {}), middle = edge_map_of(wall, {.of = EdgeOperator::intensity});
  EXPECT_EQ(faces(12, 1, 1), 1);
  EXPECT_NEAR(faces(28, 1, 1), 1, 1e-6);
  EXPECT_LT(faces(20, 1, 1), 1e-3);
  EXPECT_EQ(middle(20, 1, 1), 1);
}

TEST(EdgeMap, ReversedIsTheSameBelowZeroAndBlurKeepsAMean) {
  const Image image = drawn(box(15, 15, 15), [](const Vec3& p) { return p.norm() < 4 ? 3.0 : 1.0; });
  const Image map = edge_map_of(image, {}), reversed = edge_map_of(image, {.reversed = true});
  for (std::size_t n = 0; n < map.values.size(); ++n) EXPECT_EQ(reversed.values[n], -map.values[n]);
  const Image blurred = edge_map_of(image, {.of = EdgeOperator::intensity, .sigma_px = 1});
  EXPECT_NEAR(blurred(0, 0, 0) / blurred(7, 7, 7), 1.0 / 3, 0.01);
  EXPECT_NEAR(blurred(7, 7, 7), 1, 1e-6);
}

TEST(EdgeMap, OfAConstantImageIsZeroAndBadInputIsRefused) {
  Image image = drawn(box(4, 5, 6), [](const Vec3&) { return 7; });
  for (const EdgeOperator of : {EdgeOperator::gradient, EdgeOperator::gradient_squared, EdgeOperator::intensity})
    for (const float v : edge_map_of(image, {.of = of}).values) EXPECT_EQ(v, 0);
  EXPECT_THROW(edge_map_of(image, {.sigma_px = -1}), OptionError);
  image(1, 1, 1) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(edge_map_of(image, {}), InputError);
}

}  // namespace
}  // namespace dynasurf::field
