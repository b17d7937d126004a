#include "dynasurf/ventricle/labels/detail/division_slice.hpp"

#include <array>

#include <gtest/gtest.h>

namespace dynasurf::ventricle {
namespace {

const std::vector<bool> edges_everywhere(8, true);

TEST(CentreProfile, AveragesNinePixelsAroundTheAxis) {
  Grid g;
  g.dims = {7, 7, 2};
  Image m(g);
  m(3, 3, 0) = 9;
  m(4, 3, 1) = 9, m(5, 3, 1) = 18;
  const auto p = centre_profile(m, {3.2, 2.9, 0, 0});
  EXPECT_DOUBLE_EQ(p[0], 1);
  EXPECT_DOUBLE_EQ(p[1], 1);
  EXPECT_DOUBLE_EQ(centre_profile(m, {3, 3, 2, 0})[1], 3);  // the axis moves to column 5
  EXPECT_EQ(centre_profile(m, {-40, 3, 0, 0})[0], 0);
}

TEST(FindDivisionSlice, IsWhereTheCentreBrightensGoingDown) {
  Notes notes;
  EXPECT_EQ(find_division_slice({0.3, 0.7, 0.9, 0.2, 0.1, 0.1}, edges_everywhere, {}, notes), 2);
  EXPECT_TRUE(notes.empty());
}

TEST(FindDivisionSlice, NeedsABrightApexWall) {
  // The rise from slice 4 to 3 is large but ends in the dark: noise of the base.
  Notes notes;
  EXPECT_EQ(find_division_slice({0.5, 0.9, 0.1, 0.3, 0.1}, edges_everywhere, {}, notes), 1);
}

TEST(FindDivisionSlice, FallsBackToTheLargestRise) {
  Notes notes;
  EXPECT_EQ(find_division_slice({0.7, 0.68, 0.6, 0.5, 0.42, 0.3}, edges_everywhere, {}, notes), 4);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].code, "slice_find.fallback");
  EXPECT_EQ(notes[0].slice, 4);
}

TEST(FindDivisionSlice, FallsBackToTheLowestSliceWithEdges) {
  Notes notes;
  EXPECT_EQ(find_division_slice({0.1, 0.1, 0.2, 0.1}, {false, true, true, true}, {}, notes), 1);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].code, "slice_find.no_rise");
}

TEST(FindDivisionSlice, FindsNoneWithoutEdges) {
  for (const std::vector<double>& profile : {std::vector<double>{}, {0.5}, {0.1, 0.1}}) {
    Notes notes;
    EXPECT_EQ(find_division_slice(profile, std::vector<bool>(profile.size(), false), {}, notes), -1);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_EQ(notes[0].code, "slice_find.none");
  }
}

TEST(FindWallTip, IsTheVertexOfTheBrightestPeakUnderTheCavity) {
  // A parabola with its vertex at 2.25 and, above it, a dark cavity; farther up the base is bright again.
  std::vector<double> profile(12, 0.1);
  for (int k = 1; k <= 4; ++k) profile[static_cast<std::size_t>(k)] = 0.9 - 0.1 * (k - 2.25) * (k - 2.25);
  profile[10] = 1;
  const auto tip = find_wall_tip(profile, 5, 5, 0.4);
  ASSERT_TRUE(tip);
  EXPECT_NEAR(tip->slice, 2.25, 1e-12);
  EXPECT_NEAR(tip->brightness, 0.9 - 0.1 * 0.25 * 0.25, 1e-12);
}

TEST(FindWallTip, LooksFourCentimetresDown) {
  std::vector<double> profile(20, 0.1);
  profile[4] = 0.9;
  EXPECT_TRUE(find_wall_tip(profile, 12, 5, 0.4));
  EXPECT_FALSE(find_wall_tip(profile, 13, 5, 0.4));
}

TEST(FindWallTip, TakesTheWallAndNotTheGutUnderIt) {
  const std::vector<double> profile{0.2, 0.6, 1.0, 0.6, 0.3, 0.5, 0.7, 0.4, 0.2, 0.1, 0.1};
  EXPECT_NEAR(find_wall_tip(profile, 8, 5, 0.4)->slice, 5.9, 1e-9);
  EXPECT_EQ(find_wall_tip(profile, 8, 5, 0.8)->slice, 2);  // no wall is that bright: the brightest stands
}

TEST(FindWallTip, SeesNoneInADefectOfTheApex) {
  EXPECT_FALSE(find_wall_tip({0.1, 0.1, 0.12, 0.1, 0.09, 0.08, 0.1}, 4, 5, 0.4));
  EXPECT_FALSE(find_wall_tip({0.5, 0.4, 0.3}, -1, 5, 0.4));
  EXPECT_FALSE(find_wall_tip({0.5, 0.4, 0.3}, 3, 5, 0.4));
  EXPECT_FALSE(find_wall_tip({}, 0, 5, 0.4));
}

struct TableRow {
  int a, b, c;
  int a_plus_1;
  int expected_case, expected_move;
  bool verified;
};
class Table21 : public testing::TestWithParam<TableRow> {};

TEST_P(Table21, Decides) {
  const TableRow& row = GetParam();
  const std::array<int, 8> borders{1, 1, 1, row.c, row.b, row.a, row.a_plus_1, 2};
  Notes notes;
  const auto refined = refine_division_slice(
      3, 8, [&](int k) { return borders[static_cast<std::size_t>(k)]; }, notes);
  EXPECT_EQ(refined.table_case, row.expected_case);
  EXPECT_EQ(refined.slice, 3 + row.expected_move);
  EXPECT_EQ(refined.verified, row.verified);
  if (row.expected_case == 7) {
    EXPECT_TRUE(notes.empty());
  } else {
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_EQ(notes[0].code, "slice_refine.case_" + std::to_string(row.expected_case));
    EXPECT_EQ(notes[0].severity, row.verified ? Severity::info : Severity::warning);
  }
}

INSTANTIATE_TEST_SUITE_P(OfTheThesis, Table21,
                         testing::Values(TableRow{1, 1, 1, 2, 1, 0, false}, TableRow{1, 1, 2, 2, 2, 0, false},
                                         TableRow{1, 2, 1, 2, 3, 0, true}, TableRow{1, 2, 1, 1, 3, 0, false},
                                         TableRow{1, 2, 2, 2, 4, 0, false}, TableRow{2, 1, 1, 2, 5, 1, true},
                                         TableRow{2, 1, 2, 2, 6, 0, false}, TableRow{2, 2, 1, 2, 7, 0, true},
                                         TableRow{2, 2, 2, 2, 8, 0, false}));

TEST(RefineDivisionSlice, KeepsWhatTheTableDoesNotCover) {
  for (const int c : {-1, 3, 4}) {  // none; A outside the stack; B and A outside it
    Notes notes;
    const auto refined = refine_division_slice(
        c, 5, [](int) { return 1; }, notes);
    EXPECT_EQ(refined.slice, c);
    EXPECT_FALSE(refined.verified);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_EQ(notes[0].code, "slice_refine.not_in_table");
  }
  Notes notes;
  EXPECT_EQ(refine_division_slice(
                1, 5, [](int k) { return k == 2 ? 0 : 1; }, notes)
                .table_case,
            0);
}

}  // namespace
}  // namespace dynasurf::ventricle
