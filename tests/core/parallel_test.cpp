#include "dynasurf/core/parallel.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace dynasurf {
namespace {

TEST(ParallelFor, TouchesEveryElementOnce) {
  for (std::size_t count : {0U, 1U, 7U, 64U, 1000U}) {
    std::vector<int> touched(count, 0);
    parallel_for(count, 7, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++touched[i];
    });
    for (int t : touched) EXPECT_EQ(t, 1);
  }
}

TEST(ParallelSum, GivesTheSameBytesForAnyNumberOfThreads) {
  const auto sum_of_sines = [](std::size_t begin, std::size_t end) {
    double s = 0;
    for (std::size_t i = begin; i < end; ++i) s += std::sin(static_cast<double>(i)) * 1e-3;
    return s;
  };
  double reference = 0;
  for (int threads : {1, 2, 4, 8}) {
    const ThreadLimit limit(threads);
    const double sum = parallel_sum(100000, 128, sum_of_sines);
    if (threads == 1) reference = sum;
    EXPECT_EQ(sum, reference) << threads << " threads";
  }
}

TEST(ParallelMax, FindsTheLargestPiece) {
  EXPECT_EQ(parallel_max(100, 3, [](std::size_t begin, std::size_t) { return static_cast<double>(begin); }), 99);
  EXPECT_EQ(parallel_max(0, 3, [](std::size_t, std::size_t) { return 1.0; }), 0);
}

}  // namespace
}  // namespace dynasurf
