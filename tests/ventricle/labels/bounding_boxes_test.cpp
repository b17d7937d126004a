#include "dynasurf/ventricle/labels/detail/bounding_boxes.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dynasurf::ventricle {
namespace {

constexpr std::uint8_t endo = Labels::endo_bit, epi = Labels::epi_bit;
const Axis middle{31.5, 31.5, 0, 0};

void draw_ring(Mask& m, int k, double radius, std::uint8_t bit, double x = 31.5) {
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i)
      if (std::abs(std::hypot(i - x, j - 31.5) - radius) <= 0.5) m(i, j, k) |= bit;
}

/// Seven slices that widen up to slice 5; the cavity starts in slice 3.
Mask heart(double drift = 0) {
  Grid g;
  g.dims = {64, 64, 7};
  Mask m(g);
  const double outer[] = {5, 8, 10, 12, 13, 14, 13.5};
  for (int k = 0; k < 7; ++k) draw_ring(m, k, outer[k], epi, 31.5 + drift * k);
  for (int k = 3; k < 7; ++k) draw_ring(m, k, outer[k] - 5, endo, 31.5 + drift * k);
  return m;
}

Mask filter(const Mask& m, const Axis& axis = middle, double margin = 0, double coverage = 0, int big = 5) {
  Notes notes;
  return filter_by_boxes(m, big, 2, axis, margin, coverage, notes);
}

TEST(Boxes, LeaveAHeartThatNests) { EXPECT_EQ(filter(heart()).values, heart().values); }

TEST(Boxes, RemoveWhatLeavesThem) {
  for (int k = 0; k < 7; ++k) {
    if (k == 5) continue;  // the big slice is the judge
    Mask m = heart();
    for (int i = 50; i < 56; ++i) m(i, 31, k) = epi;
    if (k > 2) m(44, 31, k) |= endo;  // inside the outer, outside the inner box
    EXPECT_EQ(filter(m).values, heart().values) << k;
  }
}

TEST(Boxes, FilterOnceForAll) {
  Mask m = heart();
  for (int k = 0; k < 7; ++k)
    for (int n = 0; n < 40; ++n) m((n * 13 + k * 7) % 64, (n * 29 + k) % 64, k) |= static_cast<std::uint8_t>(1 + n % 2);
  for (const double margin : {0.0, 1.0, 2.5})
    for (const Axis& axis : {middle, Axis{31, 30, 0.31, -0.17}}) {
      const Mask once = filter(m, axis, margin);
      EXPECT_EQ(filter(once, axis, margin).values, once.values);
    }
}

TEST(Boxes, GiveTheMargin) {
  Mask m = heart();
  m(18, 31, 4) = epi;  // the box of slice 5 begins in column 18, that of slice 4 in column 19
  m(17, 31, 4) = epi;
  EXPECT_EQ(filter(m)(17, 31, 4), 0);
  EXPECT_EQ(filter(m, middle, 1)(17, 31, 4), epi);
}

TEST(Boxes, StartAnewAtTheDivisionSlice) {
  // With a margin of 1 the division slice may stand out by one pixel from the slices above, the apex by one more.
  Mask m = heart();
  int left = 0;
  while (!m(left, 31, 3)) ++left;
  m(left - 1, 31, 2) = m(left - 2, 31, 2) = m(left - 2, 31, 1) = m(left - 3, 31, 1) = epi;
  const Mask kept = filter(m, middle, 1);
  EXPECT_EQ(kept(left - 1, 31, 2), epi);
  EXPECT_EQ(kept(left - 2, 31, 2), 0);
  EXPECT_EQ(kept(left - 2, 31, 1), epi);
  EXPECT_EQ(kept(left - 3, 31, 1), 0);
}

TEST(Boxes, PassOnWhereABorderIsMissing) {
  Mask m = heart();
  for (auto n = m.grid.index(0, 0, 3); n < m.grid.index(0, 0, 4); ++n) m.values[n] = 0;
  Mask noisy = m;
  noisy(50, 31, 2) = epi;
  EXPECT_EQ(filter(noisy).values, m.values);
}

TEST(Boxes, OfAHalfSeenBorderDoNotCutTheOthers) {
  Mask m = heart();
  for (int j = 0; j < 64; ++j)
    for (int i = 32; i < 64; ++i) m(i, j, 4) = 0;  // a defect hides one half
  EXPECT_EQ(filter(m, middle, 0, 270).values, m.values);
  EXPECT_NE(filter(m, middle, 0, 0).values, m.values);  // the published rule
}

TEST(Boxes, MoveWithTheAxis) {
  const Mask tilted = heart(2);
  EXPECT_EQ(filter(tilted, {31.5, 31.5, 2, 0}).values, tilted.values);
  EXPECT_NE(filter(tilted).values, tilted.values);
}

TEST(Boxes, NeedABigSlice) {
  Notes notes;
  EXPECT_EQ(filter_by_boxes(heart(), -1, 2, middle, 0, 0, notes).values, heart().values);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].code, "boxes.no_big_slice");
}

TEST(Boxes, TakeAnEmptyVolume) {
  Notes notes;
  const Mask none(heart().grid);
  EXPECT_EQ(filter_by_boxes(none, 5, 2, middle, 0, 0, notes).values, none.values);
  EXPECT_EQ(filter_by_boxes(none, 0, -1, middle, 0, 0, notes).values, none.values);
}

}  // namespace
}  // namespace dynasurf::ventricle
