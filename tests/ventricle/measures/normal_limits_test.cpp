#include "dynasurf/ventricle/measures/normal_limits.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"

namespace dynasurf::ventricle {
namespace {

const PolarGrid grid;

PolarValues even(double value) { return PolarValues(grid.size(), value); }

NormalMap normal() { return build_normal_map(std::vector<PolarValues>{even(74), even(80), even(86)}, grid); }

/// A wall of 80 % with `value` in one segment.
PolarValues with_defect(int segment, double value) {
  PolarValues map = even(80);
  for (std::size_t n = 0; n < map.size(); ++n)
    if (segment_at(SegmentModel::aha17, grid.point(n)) == segment) map[n] = value;
  return map;
}

TEST(NormalMap, IsMeanAndDeviation) {
  const NormalMap map = normal();
  EXPECT_EQ(map.studies, 3);
  EXPECT_DOUBLE_EQ(*map.mean[100], 80);
  EXPECT_DOUBLE_EQ(*map.sd[100], 6);
  // Studies that happen to agree do not make the least difference a defect.
  EXPECT_DOUBLE_EQ(*build_normal_map(std::vector<PolarValues>(4, even(80)), grid).sd[0], 4);
}

TEST(NormalMap, NeedsThreeStudiesOfItsSizeAndThreeValuesPerSample) {
  EXPECT_THROW(build_normal_map(std::vector<PolarValues>(2, even(80)), grid), InputError);
  EXPECT_THROW(build_normal_map(std::vector<PolarValues>(3, PolarValues(5, 80.0)), grid), InputError);
  std::vector<PolarValues> maps(3, even(80));
  maps[1][7].reset();
  EXPECT_FALSE(build_normal_map(maps, grid).mean[7]);
}

TEST(Defect, OfOneSegmentHasItsExtentAndDepth) {
  const std::vector<double> area(grid.size(), 2.0);
  const auto defect = measure_defect(with_defect(4, 40), area, normal());
  ASSERT_TRUE(defect);
  EXPECT_NEAR(defect->extent_percent, 100.0 / 24, 1e-9);  // a sixth of the outer quarter of the rings, by equal areas
  EXPECT_NEAR(defect->severity_sd, 40.0 / 6, 1e-9);
  EXPECT_NEAR(defect->deficit_percent, 50.0 / 24, 1e-9);
  const auto none = measure_defect(even(70), area, normal());
  ASSERT_TRUE(none);
  EXPECT_EQ(none->extent_percent, 0);
  EXPECT_EQ(none->severity_sd, 0);
}

TEST(Defect, LeavesOutWhatWasNotSeen) {
  PolarValues map = with_defect(4, 40);
  for (std::size_t n = 0; n < map.size(); ++n)
    if (segment_at(SegmentModel::aha17, grid.point(n)) != 4) map[n].reset();
  EXPECT_NEAR(measure_defect(map, std::vector<double>(grid.size(), 1.0), normal())->extent_percent, 100, 1e-9);
  EXPECT_FALSE(measure_defect(PolarValues(grid.size()), std::vector<double>(grid.size(), 1.0), normal()));
}

TEST(Scores, FollowTheCutsAndTheNormals) {
  const std::vector<double> area(grid.size(), 1.0);
  const NormalMap map = normal();
  for (const auto& [value, alone, against] :
       {std::tuple(75.0, 0, 0), {62.0, 1, 1}, {55.0, 2, 1}, {40.0, 3, 2}, {10.0, 4, 4}}) {
    EXPECT_EQ(score_segments(SegmentModel::aha17, grid, with_defect(9, value), area, nullptr).score[8], alone) << value;
    EXPECT_EQ(score_segments(SegmentModel::aha17, grid, with_defect(9, value), area, &map).score[8], against) << value;
  }
  const SegmentScores scores = score_segments(SegmentModel::aha17, grid, with_defect(9, 10), area, &map);
  EXPECT_EQ(scores.sum, 4);
  EXPECT_EQ(scores.most, 68);
}

TEST(Scores, CanBeSetByHand) {
  SegmentScores scores =
      score_segments(SegmentModel::aha17, grid, even(80), std::vector<double>(grid.size(), 1.0), nullptr);
  set_score(scores, 17, 3);
  EXPECT_EQ(scores.sum, 3);
  EXPECT_TRUE(scores.by_hand[16]);
  EXPECT_THROW(set_score(scores, 18, 1), InputError);
  EXPECT_THROW(set_score(scores, 1, 5), InputError);
}

}  // namespace
}  // namespace dynasurf::ventricle
