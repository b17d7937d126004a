#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace dynasurf::cohort {

/// A number that was estimated from `n` cases, with its 95 % confidence interval; the interval is absent where too few
/// cases say anything about it.
struct ConfidentValue {
  double value = 0;
  std::optional<double> low, high;
};

/// Mean and sample standard deviation; the interval of the mean is Student's. Values that are not finite take no part
/// and are counted in `left_out`.
struct SampleSummary {
  std::size_t n = 0, left_out = 0;
  ConfidentValue mean;
  std::optional<double> sd;  // absent below two cases
};
SampleSummary summarize(std::span<const double> values);

/// Two numbers for one case: two readings, two methods, a reading and the truth.
struct ValuePair {
  double first = 0, second = 0;
};

/// Limits of agreement (Bland and Altman 1999, section 2): bias is the mean of second less first. The intervals of the
/// limits use the standard error sd sqrt(1/n + 1.96^2 / (2 (n - 1))) and Student's t. Absent below two pairs.
struct AgreementLimits {
  std::size_t n = 0, left_out = 0;
  ConfidentValue bias, low, high;
  double sd = 0;
};
std::optional<AgreementLimits> limits_of_agreement(std::span<const ValuePair> pairs);

/// Intraclass correlation of single readings, absolute agreement, two-way random effects: ICC(2,1) of Shrout and Fleiss
/// (1979), ICC(A,1) of McGraw and Wong (1996), whose interval it has. `readings[c]` are the readings of case c; all
/// have the same number, at least two. Cases with a reading that is not finite are left out. Absent below three cases,
/// and where nothing varies.
struct Icc {
  std::size_t n = 0, left_out = 0;
  ConfidentValue value;
};
std::optional<Icc> icc_absolute(std::span<const std::vector<double>> readings);

/// Repeatability of repeated studies (Bland and Altman 1999, section 4): standard deviation within subjects from a
/// one-way analysis of variance, with its chi-squared interval, and 1.96 sqrt(2) times it, within which two studies of
/// a subject differ in 95 % of cases. `repeats[s]` are the values of subject s; subjects with fewer than two finite
/// ones are left out. Absent without any other.
struct Repeatability {
  std::size_t subjects = 0, studies = 0, left_out = 0;
  ConfidentValue within_sd, coefficient;
};
std::optional<Repeatability> repeatability(std::span<const std::vector<double>> repeats);

/// Difference of the means of two groups, first less second: Welch's interval and p, and Hedges' g (the bias corrected
/// by 1 - 3 / (4 (n1 + n2) - 9)) with the interval of its large-sample standard error. Absent below two cases in a
/// group, and where nothing varies.
struct GroupDifference {
  std::size_t first_n = 0, second_n = 0, left_out = 0;
  ConfidentValue difference, hedges_g;
  double p = 1;
};
std::optional<GroupDifference> compare_groups(std::span<const double> first, std::span<const double> second);

/// A share of cases, with Wilson's interval (1927), which stays within 0 and 1 and holds for few cases, too.
/// Precondition: 0 < n, successes <= n.
ConfidentValue share_of_cases(std::size_t successes, std::size_t n);

// Distributions, by continued fractions of the incomplete beta and gamma functions and by bisection. Preconditions:
// degrees of freedom above 0, p strictly between 0 and 1.

/// Probability that Student's t is at most `t`.
double student_t_probability(double t, double degrees);
double student_t_quantile(double p, double degrees);
double f_probability(double f, double degrees1, double degrees2);
double f_quantile(double p, double degrees1, double degrees2);
double chi_squared_probability(double x, double degrees);
double chi_squared_quantile(double p, double degrees);

}  // namespace dynasurf::cohort
