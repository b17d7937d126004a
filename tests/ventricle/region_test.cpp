#include "dynasurf/ventricle/detail/region.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "support/blurred_heart.hpp"

namespace dynasurf::ventricle {
namespace {

Grid grid_of(const Index3& dims, const Vec3& spacing, const Vec3& origin) {
  Grid g;
  g.dims = dims, g.spacing = spacing, g.origin = origin;
  return g;
}

TEST(RegionOn, FollowsTheWorldAndNotTheIndices) {
  // A mask on voxels twice as large, shifted, and counted from the other end along i.
  Grid coarse = grid_of({2, 2, 1}, {2, 2, 2}, {13, 20, 0});
  coarse.direction.col(0) *= -1;  // its voxels lie at x = 13 and 11
  coarse.direction.col(2) *= -1;
  Image mask(coarse);
  mask(1, 0, 0) = 0.5F;  // around (11, 20, 0)
  const Mask region = region_on(mask, grid_of({8, 4, 1}, {1, 1, 1}, {8.5, 19.5, 0}));
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 8; ++i) {
      const double x = 8.5 + i, y = 19.5 + j;
      EXPECT_EQ(region(i, j, 0), x > 10 && x < 12 && y > 19 && y < 21) << i << " " << j;
    }
}

TEST(Confine, KeepsTheInsideAndGoesOnFromTheRim) {
  Study study;
  study.gates = {Image(grid_of({9, 5, 3}, {1, 1, 1}, {0, 0, 0}))};
  Image& image = study.gates[0];
  for (std::size_t n = 0; n < image.values.size(); ++n) image.values[n] = static_cast<float>(n % 7 + 1);
  image(8, 2, 1) = 1000;  // hot, and outside
  Mask region(image.grid);
  for (int i = 2; i <= 5; ++i)
    for (int k = 0; k < 3; ++k) region(i, 2, k) = 1;
  const Study confined = confine(study, region);
  for (int i = 2; i <= 5; ++i) EXPECT_EQ(confined.gates[0](i, 2, 1), image(i, 2, 1));
  float low = 1e9F, high = 0;
  for (int i = 2; i <= 5; ++i)
    for (int k = 0; k < 3; ++k) low = std::min(low, image(i, 2, k)), high = std::max(high, image(i, 2, k));
  for (const float v : confined.gates[0].values) {
    EXPECT_GE(v, low);
    EXPECT_LE(v, high);
  }
  ASSERT_EQ(confined.notes.size(), 1U);
  EXPECT_EQ(confined.notes[0].code, "region.used");
}

TEST(Confine, RefusesAMaskThatLiesElsewhere) {
  Study study;
  study.gates = {Image(grid_of({4, 4, 4}, {1, 1, 1}, {0, 0, 0}), 1)};
  EXPECT_THROW(confine(study, region_on(Image(grid_of({4, 4, 4}, {1, 1, 1}, {100, 0, 0}), 1), study.grid())),
               InputError);
}

Study study_of(const std::vector<test::Blob>& blobs) {
  test::HeartShape h;
  h.noise = 0.02, h.blobs = blobs;
  Study study;
  study.gates = {test::blurred_heart(h)};
  return study;
}

double endo_voxels(const BorderResult& borders) {
  const auto& values = borders.gates[0].labels.borders.values;
  return static_cast<double>(
      std::count_if(values.begin(), values.end(), [](auto v) { return (v & Labels::endo_bit) != 0; }));
}

TEST(FindBorders, LooksAtNothingOutsideAMask) {
  const Study study = study_of({{31, 56, 12, 18, 4}});  // four times as hot as the wall
  Image mask(study.grid());
  for (int k = 0; k < 23; ++k)
    for (int j = 0; j < 64; ++j)
      for (int i = 0; i < 64; ++i) mask(i, j, k) = std::hypot(i - 31.5, j - 31.5) < 15.5;
  const BorderResult alone = find_borders(study_of({}), {}), beside = find_borders(study, {}),
                     masked = find_borders(study, {}, {}, {.mask = &mask});
  const Mask region = region_on(mask, masked.study.grid());
  for (std::size_t n = 0; n < region.values.size(); ++n)
    EXPECT_FALSE(masked.gates[0].edges.edges.values[n] != 0 && region.values[n] == 0);
  // Cut to the brightness of a wall, the neighbour lifts the thresholds a little; under the mask they are the wall's
  // own.
  EXPECT_GT(endo_voxels(beside), 0.85 * endo_voxels(alone));
  EXPECT_NEAR(endo_voxels(masked), endo_voxels(alone), 0.05 * endo_voxels(alone));
}

TEST(FindBorders, FindsTheSameUnderAMaskOfEverything) {
  const Study study = study_of({});
  const Image mask(study.grid(), 1);
  EXPECT_EQ(find_borders(study, {}, {}, {.mask = &mask}).gates[0].labels.borders.values,
            find_borders(study, {}).gates[0].labels.borders.values);
}

}  // namespace
}  // namespace dynasurf::ventricle
