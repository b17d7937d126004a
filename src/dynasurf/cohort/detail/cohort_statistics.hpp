#pragma once
#include <string>
#include <vector>

#include "dynasurf/cohort/detail/cases.hpp"
#include "dynasurf/cohort/detail/statistics.hpp"

namespace dynasurf::cohort {

/// A line of statistics.tsv: what was computed, of which numbers, in whom, from how many.
struct StatisticRow {
  std::string
      statistic;   // share, mean, sd, difference, hedges_g, welch_p, bias, limit_low, limit_high, icc, within_sd, ...
  std::string of;  // the number: "ef_percent"
  std::string against;  // what it is compared with; empty where nothing is
  std::string group;    // "sex=F", "sex=F less M"; empty: all
  std::size_t n = 0, left_out = 0;
  ConfidentValue value;
};

/// What a paper says of a cohort: the share of each verdict and of runs without a result; mean and deviation of every
/// key number, in all and in each group of a column of two to six values; the difference of each two groups; agreement
/// of the readings among each other, and with the truth where the list has a column such as ef_true_percent;
/// repeatability where several studies have one `subject`. Studies without a result, or with the verdict fail, are left
/// out and counted.
std::vector<StatisticRow> statistics_of(const Cohort& cohort);

/// How the same studies came out in another cohort, the second less the first: agreement of every key number.
std::vector<StatisticRow> comparison_of(const Cohort& first, const Cohort& second);

/// The table statistics.tsv.
std::string statistics_text(const std::vector<StatisticRow>& rows);

/// The table comparison.tsv: each study of either cohort, both values and the difference of EDV, ESV, EF and the wall,
/// both verdicts, and why they differ: "input", "settings" (options or program), "one failed", "one is missing",
/// "same bytes in, other numbers out"; the largest change of EF first.
std::string changes_text(const Cohort& first, const Cohort& second);

}  // namespace dynasurf::cohort
