#include "dynasurf/cohort/detail/statistics.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace dynasurf::cohort {
namespace {

// Student's quantiles of one and two degrees are closed forms, tan(pi (p - 1/2)) and (2p - 1) / sqrt(2p (1 - p)); the
// others are what SciPy 1.10 gives from its inverse of the incomplete beta and gamma functions.
TEST(Distributions, AreThoseOfTables) {
  EXPECT_NEAR(student_t_quantile(0.975, 1), 12.706204736174707, 1e-11);
  EXPECT_NEAR(student_t_quantile(0.975, 2), 0.95 / std::sqrt(2 * 0.975 * 0.025), 1e-12);
  EXPECT_NEAR(student_t_quantile(0.975, 9), 2.2621571627982053, 1e-12);
  EXPECT_NEAR(student_t_quantile(0.025, 30), -2.0422724563012378, 1e-12);
  EXPECT_NEAR(f_quantile(0.975, 5, 15), 3.5764153492790607, 1e-12);
  EXPECT_NEAR(f_quantile(0.975, 4.3, 5), 7.305122051544648, 1e-11);
  EXPECT_NEAR(chi_squared_quantile(0.975, 10), 20.483177350807388, 1e-11);
  EXPECT_NEAR(chi_squared_quantile(0.025, 10), 3.2469727802368413, 1e-12);
  EXPECT_NEAR(student_t_probability(0, 3), 0.5, 1e-15);
}

TEST(Distributions, ReturnTheProbabilityOfTheirQuantile) {
  for (const double degrees : {1.0, 2.5, 7.0, 40.0, 9999.0})
    for (const double p : {0.001, 0.025, 0.3, 0.5, 0.9, 0.9999}) {
      EXPECT_NEAR(student_t_probability(student_t_quantile(p, degrees), degrees), p, 1e-12) << degrees << " " << p;
      EXPECT_NEAR(f_probability(f_quantile(p, degrees, 6), degrees, 6), p, 1e-12) << degrees << " " << p;
      EXPECT_NEAR(chi_squared_probability(chi_squared_quantile(p, degrees), degrees), p, 1e-11) << degrees << " " << p;
    }
}

TEST(ShareOfCases, HasWilsonsInterval) {
  // Newcombe 1998, table I, method 3: 81 of 263, 15 of 148, 0 of 20, 1 of 29.
  const auto expect = [](std::size_t successes, std::size_t n, double low, double high) {
    const ConfidentValue share = share_of_cases(successes, n);
    EXPECT_DOUBLE_EQ(share.value, static_cast<double>(successes) / static_cast<double>(n));
    EXPECT_NEAR(*share.low, low, 5e-5) << successes;
    EXPECT_NEAR(*share.high, high, 5e-5) << successes;
  };
  expect(81, 263, 0.2553, 0.3662);
  expect(15, 148, 0.0624, 0.1605);
  expect(0, 20, 0, 0.1611);
  expect(1, 29, 0.0061, 0.1718);
  EXPECT_EQ(share_of_cases(5, 5).high, 1);
}

TEST(Summary, IsMeanAndSampleDeviationOfWhatIsFinite) {
  const std::vector<double> values{1, 2, 3, 4, std::numeric_limits<double>::quiet_NaN()};
  const SampleSummary summary = summarize(values);
  EXPECT_EQ(summary.n, 4U);
  EXPECT_EQ(summary.left_out, 1U);
  EXPECT_DOUBLE_EQ(summary.mean.value, 2.5);
  EXPECT_NEAR(*summary.sd, 1.2909944487358056, 1e-15);
  EXPECT_NEAR(*summary.mean.low, 2.5 - 3.182446305284263 * 1.2909944487358056 / 2, 1e-12);
}

TEST(Summary, SaysNothingOfASpreadOfOne) {
  const std::vector<double> one{7};
  EXPECT_FALSE(summarize(one).sd);
  EXPECT_FALSE(summarize(one).mean.low);
  EXPECT_EQ(summarize(std::vector<double>{}).n, 0U);
}

// Peak expiratory flow of Bland and Altman (1986), large meter and mini meter, first readings: mean difference -2.1
// (large less mini), SD 38.8, limits -79.7 and 75.5 with 2 SD.
const std::vector<ValuePair>& flow_meters() {
  static const std::vector<ValuePair> pairs{{494, 512}, {395, 430}, {516, 520}, {434, 428}, {476, 500}, {557, 600},
                                            {413, 364}, {442, 380}, {650, 658}, {433, 445}, {417, 432}, {656, 626},
                                            {267, 260}, {478, 477}, {178, 259}, {423, 350}, {427, 451}};
  return pairs;
}

TEST(Agreement, IsThatOfBlandAndAltman) {
  const auto limits = limits_of_agreement(flow_meters());
  EXPECT_EQ(limits->n, 17U);
  EXPECT_NEAR(limits->bias.value, 2.1, 0.05);
  EXPECT_NEAR(limits->sd, 38.8, 0.05);
  EXPECT_NEAR(limits->high.value, 2.1 + 1.96 * 38.8, 0.1);
  // Their standard error of a limit is sqrt(3 s^2 / n) = 9.4 s; 2.12 of them on each side.
  EXPECT_NEAR(*limits->high.high - limits->high.value, 2.12 * std::sqrt(3 * 38.8 * 38.8 / 17), 1.5);
}

TEST(Agreement, NeedsTwoPairs) { EXPECT_FALSE(limits_of_agreement(std::vector<ValuePair>{{1, 2}})); }

// Table 2 of Shrout and Fleiss (1979), four judges of six targets: ICC(2,1) = 0.29; McGraw and Wong's interval of it is
// 0.019 to 0.761 (package irr of R and others).
TEST(Icc, IsThatOfShroutAndFleiss) {
  const std::vector<std::vector<double>> ratings{{9, 2, 5, 8}, {6, 1, 3, 2},  {8, 4, 6, 8},
                                                 {7, 1, 2, 6}, {10, 5, 6, 9}, {6, 2, 4, 7}};
  const auto icc = icc_absolute(ratings);
  EXPECT_NEAR(icc->value.value, 0.2897638, 1e-6);
  EXPECT_NEAR(*icc->value.low, 0.0187865, 1e-5);
  EXPECT_NEAR(*icc->value.high, 0.7610844, 1e-5);
}

TEST(Icc, IsOneWhereReadingsAreTheSameAndAbsentWhereNothingVaries) {
  EXPECT_DOUBLE_EQ(icc_absolute(std::vector<std::vector<double>>{{1, 1}, {2, 2}, {5, 5}})->value.value, 1);
  EXPECT_FALSE(icc_absolute(std::vector<std::vector<double>>{{3, 3}, {3, 3}, {3, 3}}));
}

TEST(Repeats, GiveTheDeviationWithinSubjects) {
  // Pairs: the variance within is the sum of squared differences over 2 n.
  const std::vector<std::vector<double>> repeats{{10, 12}, {20, 19}, {30, 33}, {40}};
  const auto result = repeatability(repeats);
  EXPECT_EQ(result->subjects, 3U);
  EXPECT_EQ(result->left_out, 1U);
  EXPECT_NEAR(result->within_sd.value, std::sqrt((4 + 1 + 9) / 6.0), 1e-14);
  EXPECT_NEAR(result->coefficient.value, 2.7718585822512662 * result->within_sd.value, 1e-12);
  EXPECT_LT(*result->within_sd.low, result->within_sd.value);
  EXPECT_GT(*result->within_sd.high, result->within_sd.value);
}

TEST(Groups, DifferByWelchAndHedges) {
  const std::vector<double> a{27.5, 21.0, 19.0, 23.6, 17.0, 17.9, 16.9, 20.1, 21.9, 22.6, 23.1, 19.6, 19.0, 21.7, 21.4};
  const std::vector<double> b{27.1, 22.0, 20.8, 23.4, 23.4, 23.5, 25.8, 22.0, 24.8, 20.2, 21.9, 22.1, 22.9, 30.5, 27.2};
  const auto difference = compare_groups(a, b);
  EXPECT_NEAR(difference->p, 0.00618, 0.0002);
  EXPECT_NEAR(difference->difference.value, -3.02, 0.01);
  EXPECT_LT(*difference->difference.high, 0);
  EXPECT_LT(difference->hedges_g.value, -1);
}

TEST(Groups, ThatDoNotVaryAreNotCompared) {
  EXPECT_FALSE(compare_groups(std::vector<double>{1, 1}, std::vector<double>{2, 2}));
  EXPECT_FALSE(compare_groups(std::vector<double>{1}, std::vector<double>{2, 3}));
}

}  // namespace
}  // namespace dynasurf::cohort
