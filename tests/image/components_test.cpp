#include "dynasurf/image/detail/components.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dynasurf::image {
namespace {

Mask drawing(const std::vector<std::string>& rows) {
  Grid g;
  g.dims = {static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), 1};
  Mask m(g);
  for (int j = 0; j < g.dims[1]; ++j)
    for (int i = 0; i < g.dims[0]; ++i)
      m(i, j, 0) = rows[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] == '#';
  return m;
}

TEST(Components, JoinAcrossCornersAndNotAcrossGaps) {
  const auto found = components_of_slice(drawing({"#..#.", ".#..#", "..#..", ".....", "##..#"}), 0);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_THAT(found[0].pixels, testing::ElementsAre(Pixel{0, 0}, Pixel{1, 1}, Pixel{2, 2}));
  EXPECT_THAT(found[1].pixels, testing::ElementsAre(Pixel{3, 0}, Pixel{4, 1}));
}

TEST(Components, HoldEveryPixelOnce) {
  const Mask m = drawing({"##.#.##", "#.#.#.#", ".##..##", "#..##.."});
  std::size_t sum = 0;
  for (const Component& c : components_of_slice(m, 0)) {
    for (const Pixel& p : c.pixels) EXPECT_TRUE(m(p.i, p.j, 0));
    sum += c.pixels.size();
  }
  EXPECT_EQ(sum, static_cast<std::size_t>(std::count(m.values.begin(), m.values.end(), 1)));
}

TEST(Components, FindAPixelThatIsAloneWhereverItIs) {
  Grid g;
  g.dims = {7, 5, 2};
  for (int j = 0; j < g.dims[1]; ++j)
    for (int i = 0; i < g.dims[0]; ++i) {
      Mask m(g);
      m(i, j, 1) = 1;
      EXPECT_TRUE(components_of_slice(m, 0).empty());
      const auto found = components_of_slice(m, 1);
      ASSERT_EQ(found.size(), 1U) << i << ' ' << j;
      EXPECT_THAT(found[0].pixels, testing::ElementsAre(Pixel{i, j}));
    }
}

TEST(Components, OfAnEmptySliceAreNone) { EXPECT_TRUE(components_of_slice(drawing({"...", "..."}), 0).empty()); }

TEST(MeanOf, IsTheCentreOfThePixels) {
  const PixelMean mean = mean_of({{0, 0}, {2, 0}, {2, 6}, {0, 6}});
  EXPECT_EQ(mean.x_px, 1);
  EXPECT_EQ(mean.y_px, 3);
}

}  // namespace
}  // namespace dynasurf::image
