#include "dynasurf/cohort/detail/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace dynasurf::cohort {
namespace {

constexpr double certainty = 0.975;  // each side of a 95 % interval
constexpr double normal_quantile = 1.959963984540054;

double count(std::size_t n) { return n; }

/// Two passes: a large mean costs no digits of the spread.
double mean_of(std::span<const double> values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / count(values.size());
}

double squares_about(std::span<const double> values, double mean) {
  double sum = 0;
  for (const double v : values) sum += (v - mean) * (v - mean);
  return sum;
}

std::vector<double> finite_of(std::span<const double> values) {
  std::vector<double> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite), [](double v) { return std::isfinite(v); });
  return finite;
}

ConfidentValue within(double value, double half_width) { return {value, value - half_width, value + half_width}; }

/// Mean squares of a two-way layout of cases and readers.
struct MeanSquares {
  double cases = 0, readers = 0, error = 0;
};

MeanSquares mean_squares(const std::vector<std::vector<double>>& rows) {
  const std::size_t n = rows.size(), k = rows.front().size();
  std::vector<double> all, case_means, reader_means(k, 0.0);
  for (const auto& row : rows) {
    all.insert(all.end(), row.begin(), row.end());
    case_means.push_back(mean_of(row));
    for (std::size_t r = 0; r < k; ++r) reader_means[r] += row[r] / count(n);
  }
  const double mean = mean_of(all);
  const double between_cases = count(k) * squares_about(case_means, mean);
  const double between_readers = count(n) * squares_about(reader_means, mean);
  const double rest = std::max(0.0, squares_about(all, mean) - between_cases - between_readers);
  return {between_cases / count(n - 1), between_readers / count(k - 1), rest / count((n - 1) * (k - 1))};
}

/// Interval of McGraw and Wong (1996), table 7, case 2A, ICC(A,1).
ConfidentValue icc_with_interval(const MeanSquares& ms, std::size_t cases, std::size_t readers) {
  const double n = count(cases), k = count(readers);
  const double icc = (ms.cases - ms.error) / (ms.cases + (k - 1) * ms.error + k * (ms.readers - ms.error) / n);
  if (ms.error <= 0 || icc >= 1) return {icc, {}, {}};
  const double a = k * icc / (n * (1 - icc)), b = 1 + k * icc * (n - 1) / (n * (1 - icc));
  const double top = a * ms.readers + b * ms.error;
  const double v =
      top * top / (a * ms.readers * a * ms.readers / (k - 1) + b * ms.error * b * ms.error / ((n - 1) * (k - 1)));
  if (!std::isfinite(v) || v <= 0) return {icc, {}, {}};
  const double f_low = f_quantile(certainty, n - 1, v), f_high = f_quantile(certainty, v, n - 1);
  const double spread = k * ms.readers + (k * n - k - n) * ms.error;
  return {icc, n * (ms.cases - f_low * ms.error) / (f_low * spread + n * ms.cases),
          n * (f_high * ms.cases - ms.error) / (spread + n * f_high * ms.cases)};
}

}  // namespace

SampleSummary summarize(std::span<const double> values) {
  const std::vector<double> finite = finite_of(values);
  SampleSummary summary;
  summary.n = finite.size();
  summary.left_out = values.size() - finite.size();
  if (finite.empty()) return summary;
  summary.mean.value = mean_of(finite);
  if (finite.size() < 2) return summary;
  summary.sd = std::sqrt(squares_about(finite, summary.mean.value) / count(finite.size() - 1));
  const double t = student_t_quantile(certainty, count(finite.size() - 1));
  summary.mean = within(summary.mean.value, t * *summary.sd / std::sqrt(count(finite.size())));
  return summary;
}

std::optional<AgreementLimits> limits_of_agreement(std::span<const ValuePair> pairs) {
  std::vector<double> differences;
  for (const ValuePair& pair : pairs) differences.push_back(pair.second - pair.first);
  const SampleSummary summary = summarize(differences);
  if (!summary.sd) return std::nullopt;
  const double n = count(summary.n), sd = *summary.sd, z = 1.96;
  const double half = student_t_quantile(certainty, n - 1) * sd * std::sqrt(1 / n + z * z / (2 * (n - 1)));
  return AgreementLimits{summary.n,
                         summary.left_out,
                         summary.mean,
                         within(summary.mean.value - z * sd, half),
                         within(summary.mean.value + z * sd, half),
                         sd};
}

std::optional<Icc> icc_absolute(std::span<const std::vector<double>> readings) {
  std::vector<std::vector<double>> rows;
  for (const std::vector<double>& row : readings)
    if (row.size() >= 2 && row.size() == readings.front().size() && finite_of(row).size() == row.size())
      rows.push_back(row);
  if (rows.size() < 3) return std::nullopt;
  const MeanSquares ms = mean_squares(rows);
  if (!(ms.cases > 0)) return std::nullopt;
  return Icc{rows.size(), readings.size() - rows.size(), icc_with_interval(ms, rows.size(), rows.front().size())};
}

std::optional<Repeatability> repeatability(std::span<const std::vector<double>> repeats) {
  Repeatability result;
  double squares = 0, degrees = 0;
  for (const std::vector<double>& subject : repeats) {
    const std::vector<double> values = finite_of(subject);
    if (values.size() < 2) {
      ++result.left_out;
      continue;
    }
    ++result.subjects;
    result.studies += values.size();
    squares += squares_about(values, mean_of(values));
    degrees += count(values.size() - 1);
  }
  if (result.subjects == 0) return std::nullopt;
  const double factor = 1.96 * std::sqrt(2.0);
  const double sd = std::sqrt(squares / degrees);
  result.within_sd = {sd, std::sqrt(squares / chi_squared_quantile(certainty, degrees)),
                      std::sqrt(squares / chi_squared_quantile(1 - certainty, degrees))};
  result.coefficient = {factor * sd, factor * *result.within_sd.low, factor * *result.within_sd.high};
  return result;
}

ConfidentValue share_of_cases(std::size_t successes, std::size_t n) {
  const double cases = count(n), share = count(successes) / cases, z = normal_quantile, z2 = z * z / cases;
  const double middle = (share + z2 / 2) / (1 + z2);
  const double half = z / (1 + z2) * std::sqrt(share * (1 - share) / cases + z2 / (4 * cases));
  // At 0 and n of n the limit is exact; rounding would put it beside the share.
  return {share, successes == 0 ? 0 : middle - half, successes == n ? 1 : middle + half};
}

std::optional<GroupDifference> compare_groups(std::span<const double> first, std::span<const double> second) {
  const SampleSummary a = summarize(first), b = summarize(second);
  if (!a.sd || !b.sd || (*a.sd == 0 && *b.sd == 0)) return std::nullopt;
  const double n1 = count(a.n), n2 = count(b.n);
  const double v1 = *a.sd * *a.sd / n1, v2 = *b.sd * *b.sd / n2;
  // Degrees of freedom of Welch and Satterthwaite.
  const double degrees = (v1 + v2) * (v1 + v2) / (v1 * v1 / (n1 - 1) + v2 * v2 / (n2 - 1));
  const double error = std::sqrt(v1 + v2);
  GroupDifference result{a.n, b.n, a.left_out + b.left_out, {}, {}, 1};
  const double difference = a.mean.value - b.mean.value;
  result.difference = within(difference, student_t_quantile(certainty, degrees) * error);
  result.p = 2 * student_t_probability(-std::abs(difference / error), degrees);
  const double pooled = std::sqrt(((n1 - 1) * *a.sd * *a.sd + (n2 - 1) * *b.sd * *b.sd) / (n1 + n2 - 2));
  const double g = (1 - 3 / (4 * (n1 + n2) - 9)) * difference / pooled;
  const double error_of_g = std::sqrt((n1 + n2) / (n1 * n2) + g * g / (2 * (n1 + n2)));
  result.hedges_g = within(g, normal_quantile * error_of_g);
  return result;
}

}  // namespace dynasurf::cohort
