#include "dynasurf/synthetic/detail/random.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace dynasurf::synthetic {
namespace {

struct Moments {
  double mean = 0, variance = 0, skewness = 0;
};

template <class Draw>
Moments moments_of(int count, const Draw& draw) {
  std::vector<double> x(static_cast<std::size_t>(count));
  Moments m;
  for (int n = 0; n < count; ++n) m.mean += x[static_cast<std::size_t>(n)] = draw(n);
  m.mean /= count;
  double cubes = 0;
  for (double v : x) m.variance += (v - m.mean) * (v - m.mean), cubes += std::pow(v - m.mean, 3);
  m.variance /= count;
  m.skewness = m.variance > 0 ? cubes / count / std::pow(m.variance, 1.5) : 0;
  return m;
}

TEST(Random, RepeatsItselfForTheSameSeedStreamAndPosition) {
  Random a(7, 2, 5), b(7, 2, 5);
  for (int n = 0; n < 100; ++n) EXPECT_EQ(a.next(), b.next());
}

TEST(Random, IsTheSameOnEveryMachine) {
  // Written down once: a changed generator changes every published phantom.
  Random random(1, 0, 0);
  EXPECT_EQ(random.next(), 744399551142447258ULL);
  EXPECT_EQ(random.next(), 10344128817777182241ULL);
}

TEST(Random, DiffersBetweenSeedsStreamsAndNeighbouringPositions) {
  const auto first = Random(1, 1, 1).next();
  EXPECT_NE(first, Random(2, 1, 1).next());
  EXPECT_NE(first, Random(1, 2, 1).next());
  EXPECT_NE(first, Random(1, 1, 2).next());
}

TEST(Random, GivesUncorrelatedUniformsToNeighbouringPositions) {
  constexpr int count = 200000;
  double sum = 0, square = 0, product = 0, last = 0.5;
  for (int n = 0; n < count; ++n) {
    const double u = Random(3, 0, static_cast<std::uint64_t>(n)).uniform() - 0.5;
    EXPECT_GT(u, -0.5);
    EXPECT_LT(u, 0.5);
    sum += u, square += u * u, product += u * last, last = u;
  }
  // Five standard errors of each mean.
  EXPECT_NEAR(sum / count, 0, 5 * std::sqrt(1.0 / 12 / count));
  EXPECT_NEAR(square / count, 1.0 / 12, 5 * std::sqrt(1.0 / 180 / count));
  EXPECT_NEAR(product / count, 0, 5.0 / 12 / std::sqrt(count));
}

TEST(Random, DrawsStandardNormals) {
  constexpr int count = 200000;
  Random random(11);
  const Moments m = moments_of(count, [&](int) { return random.normal(); });
  EXPECT_NEAR(m.mean, 0, 5 / std::sqrt(count));
  EXPECT_NEAR(m.variance, 1, 5 * std::sqrt(2.0 / count));
  EXPECT_NEAR(m.skewness, 0, 5 * std::sqrt(6.0 / count));
}

class PoissonMean : public ::testing::TestWithParam<double> {};

TEST_P(PoissonMean, HasVarianceEqualToItsMeanAndTheRightSkewness) {
  const double mean = GetParam();
  constexpr int count = 200000;
  const Moments m = moments_of(count, [&](int n) { return Random(5, 1, static_cast<std::uint64_t>(n)).poisson(mean); });
  EXPECT_NEAR(m.mean, mean, 5 * std::sqrt(mean / count));
  // Variance of the sample variance of a Poisson law: (mean + 2 mean^2) / n.
  EXPECT_NEAR(m.variance, mean, 5 * std::sqrt((mean + 2 * mean * mean) / count));
  EXPECT_NEAR(m.skewness, 1 / std::sqrt(mean), 0.03 + 0.05 / std::sqrt(mean));
}

TEST_P(PoissonMean, HasTheProbabilitiesOfThePoissonLaw) {
  const double mean = GetParam();
  constexpr int count = 100000;
  std::vector<int> seen(static_cast<std::size_t>(mean + 10 * std::sqrt(mean) + 20), 0);
  for (int n = 0; n < count; ++n) {
    const double k = Random(6, 0, static_cast<std::uint64_t>(n)).poisson(mean);
    ASSERT_EQ(k, std::floor(k));
    ASSERT_LT(k, static_cast<double>(seen.size()));
    ++seen[static_cast<std::size_t>(k)];
  }
  double chi_square = 0, bins = 0, log_p = -mean;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (k > 0) log_p += std::log(mean / static_cast<double>(k));
    const double expected = count * std::exp(log_p);
    if (expected < 10) continue;
    chi_square += (seen[k] - expected) * (seen[k] - expected) / expected;
    ++bins;
  }
  EXPECT_LT(chi_square, bins + 5 * std::sqrt(2 * bins));
}

// 9.9 and 10 lie on both sides of the change of sampler.
INSTANTIATE_TEST_SUITE_P(Means, PoissonMean, ::testing::Values(0.3, 4.0, 9.9, 10.0, 30.0, 120.0, 1000.0));

TEST(Random, DrawsNothingFromAMeanOfZero) { EXPECT_EQ(Random(1).poisson(0), 0); }

}  // namespace
}  // namespace dynasurf::synthetic
