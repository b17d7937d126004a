#pragma once
#include <span>
#include <string>
#include <vector>

namespace dynasurf::report {

/// A number that was measured, and what it should have been.
struct PairedReading {
  double truth = 0, measured = 0;
};

/// How readings differ from the truth (Bland and Altman 1986): `bias` is the mean of measured minus truth, `sd` its
/// sample standard deviation (0 for fewer than two), `low` and `high` the 95 % limits of agreement, bias -+ 1.96 sd.
struct Agreement {
  std::size_t count = 0;
  double bias = 0, sd = 0, low = 0, high = 0;
};

/// Pairs with a number that is not finite take no part. No pair: all zero.
Agreement agreement_of(std::span<const PairedReading> readings);
/// The same of differences in percent of the truth; pairs whose truth is not positive take no part either.
Agreement relative_agreement_of(std::span<const PairedReading> readings);

/// Readings that are drawn alike: "no defect", "a third of the wall", ...
struct ReadingGroup {
  std::string name;
  std::vector<PairedReading> readings;
};

/// What stands on the axes.
struct AgreementPlot {
  std::string title, unit;
  bool relative = false;  // differences in percent of the truth
};

/// The differences over the truth as a picture: a dot per reading, one colour and one shape per group, the bias and the
/// limits of agreement of all groups together. Plain SVG 1.1, nothing is loaded; text is escaped. Without a pair the
/// frame says so. The truth stands on the x axis, not the mean of both as where neither is known.
std::string bland_altman_svg(std::span<const ReadingGroup> groups, const AgreementPlot& plot);

}  // namespace dynasurf::report
