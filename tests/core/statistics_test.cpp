#include "dynasurf/core/detail/statistics.hpp"

#include <gtest/gtest.h>

namespace dynasurf {
namespace {

TEST(Statistics, FindsAValueByItsRank) {
  const std::vector<int> values{5, 1, 4, 1, 3};
  for (std::size_t rank = 0; rank < 5; ++rank) EXPECT_EQ(of_rank(values, rank), (std::vector{1, 1, 3, 4, 5})[rank]);
  EXPECT_EQ(of_rank(values, 5), 0);
}

TEST(Statistics, TakesTheMiddleOfTheMiddleValuesOrTheUpperOne) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 3, 2}), 2.5);
  EXPECT_EQ(median({}), 0);
  EXPECT_EQ(upper_median(std::vector{3.0, 1.0, 2.0}), 2);
  EXPECT_EQ(upper_median(std::vector{4, 1, 3, 2}), 3);
  EXPECT_EQ(upper_median(std::vector<double>{}), 0);
}

TEST(Statistics, RoundsTheRankOfAQuantileDown) {
  const std::vector<float> values{0, 10, 20, 30, 40};
  EXPECT_EQ(quantile(values, 0), 0);
  EXPECT_EQ(quantile(values, 0.74), 20);
  EXPECT_EQ(quantile(values, 0.75), 30);
  EXPECT_EQ(quantile(values, 1), 40);
  EXPECT_EQ(quantile(std::vector<float>{}, 0.5), 0);
}

}  // namespace
}  // namespace dynasurf
