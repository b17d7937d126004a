#include "dynasurf/report/detail/bland_altman.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "texts.hpp"

namespace dynasurf::report {
namespace {

// Differences -1, 0, 1, 4: mean 1, sample variance (4 + 1 + 0 + 9) / 3.
const std::vector<PairedReading> four{{10, 9}, {20, 20}, {50, 51}, {80, 84}};

TEST(Agreement, IsMeanAndSampleDeviationOfTheDifferences) {
  const Agreement a = agreement_of(four);
  EXPECT_EQ(a.count, 4u);
  EXPECT_DOUBLE_EQ(a.bias, 1);
  EXPECT_DOUBLE_EQ(a.sd, std::sqrt(14.0 / 3));
  EXPECT_DOUBLE_EQ(a.high, 1 + 1.96 * std::sqrt(14.0 / 3));
  EXPECT_DOUBLE_EQ(a.low, 1 - 1.96 * std::sqrt(14.0 / 3));
  // In percent: -10, 0, 2, 5.
  EXPECT_DOUBLE_EQ(relative_agreement_of(four).bias, -0.75);
}

TEST(Agreement, LeavesOutWhatHasNoDifference) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const std::vector<PairedReading> readings{{none, 1}, {1, none}, {0, 3}, {10, 11}};
  EXPECT_EQ(agreement_of(readings).count, 2u);
  EXPECT_EQ(relative_agreement_of(readings).count, 1u);
  EXPECT_EQ(relative_agreement_of(readings).sd, 0);
  EXPECT_EQ(agreement_of({}).count, 0u);
}

TEST(BlandAltmanPlot, DrawsEveryReadingAndTheLimits) {
  const ReadingGroup plain{"no defect", four}, defect{"a <third> & more", {{30, 33}}};
  const std::string svg = bland_altman_svg(std::vector{plain, defect}, {"EDV", "mL"});
  EXPECT_EQ(count_of(svg, "<circle"), 5u);  // four readings, one in the legend
  EXPECT_EQ(count_of(svg, "M-3 -3H3V3H-3Z"), 2u);
  EXPECT_EQ(count_of(svg, "stroke-dasharray"), 2u);
  EXPECT_NE(svg.find("EDV (n = 5)"), std::string::npos);
  EXPECT_NE(svg.find("1.4 mean"), std::string::npos);  // (4 + 3) / 5
  EXPECT_NE(svg.find("a &lt;third&gt; &amp; more"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_NE(bland_altman_svg(std::vector{plain}, {"EDV", "mL", true}).find("measured less truth, %"),
            std::string::npos);
}

TEST(BlandAltmanPlot, ShowsAFrameForNoReadingAndForOne) {
  EXPECT_NE(bland_altman_svg({}, {"EF", "points"}).find("no readings"), std::string::npos);
  const std::string one = bland_altman_svg(std::vector{ReadingGroup{"one", {{60, 60}}}}, {"EF", "points"});
  EXPECT_EQ(count_of(one, "<circle"), 1u);
  EXPECT_EQ(one.find("nan"), std::string::npos);
  EXPECT_EQ(one.find("inf"), std::string::npos);
}

}  // namespace
}  // namespace dynasurf::report
