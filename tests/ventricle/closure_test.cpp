#include "dynasurf/ventricle/detail/closure.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dynasurf::ventricle {
namespace {

constexpr double ring_radius = 7;

Image rings(int first, int last, double gap_from_deg = 0, double gap_to_deg = 0) {
  Grid grid;
  grid.dims = {32, 32, 16};
  Image image(grid);
  for (int k = first; k <= last; ++k)
    for (int j = 0; j < 32; ++j)
      for (int i = 0; i < 32; ++i) {
        const double degrees = std::atan2(j - 16, i - 16) * 180 / M_PI;
        if (std::abs(std::hypot(i - 16, j - 16) - ring_radius) < 0.5 &&
            !(degrees > gap_from_deg && degrees < gap_to_deg))
          image(i, j, k) = 1;
      }
  return image;
}

int voxels_in_slice(const Image& image, int k) {
  int count = 0;
  for (int j = 0; j < 32; ++j)
    for (int i = 0; i < 32; ++i) count += image(i, j, k) > 0;
  return count;
}

TEST(CloseBorder, FillsBothEndsAndNothingBetween) {
  const Image open = rings(3, 10);
  const Image closed = close_border(open, 10);
  const double disc = M_PI * (ring_radius + 0.5) * (ring_radius + 0.5);
  EXPECT_NEAR(voxels_in_slice(closed, 3), disc, 0.1 * disc);  // a pixelated disc
  EXPECT_NEAR(voxels_in_slice(closed, 10), disc, 0.1 * disc);
  for (int k = 4; k <= 9; ++k) EXPECT_EQ(voxels_in_slice(closed, k), voxels_in_slice(open, k));
}

TEST(CloseBorder, CutsOffWhatLiesAboveTheBase) {
  const Image closed = close_border(rings(3, 12), 9);
  EXPECT_GT(voxels_in_slice(closed, 9), 100);
  for (int k = 10; k < 16; ++k) EXPECT_EQ(voxels_in_slice(closed, k), 0);
}

TEST(CloseBorder, CompletesATornOrMissingRingFromTheSlicesBelow) {
  Image torn = rings(3, 10);
  const Image half = rings(3, 10, 10, 120);
  for (int j = 0; j < 32; ++j)
    for (int i = 0; i < 32; ++i) torn(i, j, 9) = half(i, j, 9), torn(i, j, 10) = half(i, j, 10);
  EXPECT_EQ(voxels_in_slice(close_border(torn, 10), 10), voxels_in_slice(close_border(rings(3, 10), 10), 10));
  EXPECT_EQ(voxels_in_slice(close_border(rings(3, 7), 10), 10), voxels_in_slice(close_border(rings(3, 10), 10), 10));
}

TEST(CloseBorder, LeavesAnEmptyBorderEmpty) {
  const Image empty = rings(5, 4);
  EXPECT_EQ(close_border(empty, 10).values, empty.values);
  EXPECT_EQ(close_border(rings(5, 9), -1).values, empty.values);
}

TEST(WithRoom, GrowsTheGridOnlyWhereRoomIsMissingAndMovesNothingInTheWorld) {
  const Image cramped = rings(0, 14);  // 16 slices: none free below, one free above, 8 pixels free at the sides
  const Image roomy = with_room(cramped, 3);
  EXPECT_EQ(roomy.grid.dims, (Index3{32, 32, 16 + 3 + 2}));
  for (int k = 0; k < 16; ++k)
    for (int j = 0; j < 32; ++j)
      for (int i = 0; i < 32; ++i) ASSERT_EQ(roomy(i, j, k + 3), cramped(i, j, k));
  EXPECT_LT((to_world(roomy.grid, centre_of(roomy.grid, {5, 6, 10})) -
             to_world(cramped.grid, centre_of(cramped.grid, {5, 6, 7})))
                .norm(),
            1e-12);
  EXPECT_EQ(with_room(rings(3, 10), 3).grid, cramped.grid);
  EXPECT_EQ(with_room(rings(5, 4), 3).grid, cramped.grid) << "an empty border";
}

TEST(FindBaseSlice, StopsWhereTheWallFallsToHalf) {
  Image image = rings(2, 12);
  for (int j = 0; j < 32; ++j)
    for (int i = 0; i < 32; ++i) image(i, j, 11) *= 0.6F, image(i, j, 12) *= 0.4F;
  Labels labels;
  labels.borders = Mask(image.grid);
  labels.circle = {16, 16, 10};
  for (int k = 2; k <= 9; ++k) labels.borders(16 + 7, 16, k) = Labels::epi_bit;
  Notes notes;
  EXPECT_EQ(find_base_slice(image, labels, 0.5, notes), 11);
  EXPECT_EQ(find_base_slice(image, labels, 0.7, notes), 10);
  EXPECT_TRUE(notes.empty());
}

TEST(FindBaseSlice, WarnsWhenTheBaseLiesOutsideTheVolume) {
  const Image image = rings(2, 15);
  Labels labels;
  labels.borders = Mask(image.grid);
  labels.circle = {16, 16, 10};
  Notes notes;
  EXPECT_EQ(find_base_slice(image, labels, 0.5, notes), -1) << "nothing labelled";
  for (int k = 2; k <= 15; ++k) labels.borders(16 + 7, 16, k) = Labels::epi_bit;
  EXPECT_EQ(find_base_slice(image, labels, 0.5, notes), 15);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].code, "base.cut_off");
}

}  // namespace
}  // namespace dynasurf::ventricle
