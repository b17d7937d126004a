#include "dynasurf/report/measures.hpp"

#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/sample_result.hpp"
#include "texts.hpp"

namespace dynasurf::report {
namespace {

const ventricle::Result& sample() {
  static const ventricle::Result result = test::sample_result();
  return result;
}

auto commas(const std::string& line) { return std::count(line.begin(), line.end(), ','); }

TEST(MeasuresJson, HoldsEverySegmentAndIsNullWithoutSurfaces) {
  const auto json = measures_json(sample().measures, sample().study.cycle_ms);
  ASSERT_EQ(json["segments"].size(), 17u);
  EXPECT_EQ(json["segments"][12]["name"], "apical anterior");
  EXPECT_EQ(json["thickness_is"], "apparent");
  EXPECT_EQ(json["thickness"].size(), sample().gates.size());
  EXPECT_NEAR(json["function"]["peak_filling_edv_per_s"].get<double>(),
              json["function"]["peak_filling_edv_per_beat"].get<double>() / 0.88, 1e-12);
  EXPECT_TRUE(measures_json(test::sample_failed().measures, 880).is_null());
  // Without the R-R interval there is no rate per second.
  EXPECT_TRUE(measures_json(sample().measures, 0)["function"]["peak_filling_edv_per_s"].is_null());
}

TEST(MeasuresTables, HaveOneLinePerSegmentAndPerSample) {
  const ventricle::Measures& m = *sample().measures;
  const auto segments = lines_of(segments_csv(m)), polar = lines_of(polar_csv(m)),
             curve = lines_of(curve_csv(*m.function));
  ASSERT_EQ(segments.size(), 18u);
  ASSERT_EQ(polar.size(), 1 + m.grid.size());
  ASSERT_EQ(curve.size(), 65u);
  for (const auto* table : {&segments, &polar, &curve})
    for (const std::string& line : *table) EXPECT_EQ(commas(line), commas(table->front())) << line;
  EXPECT_EQ(polar[1].substr(0, 4), "1,1,");
}

TEST(PolarPicture, ShowsEverySampleAndEverySegment) {
  const ventricle::Measures& m = *sample().measures;
  for (const PolarKind& kind : polar_kinds()) {
    const std::string svg = polar_svg(m, kind);
    const ventricle::PolarValues& values = m.maps.*kind.values;
    const auto present = static_cast<std::size_t>(
        std::count_if(values.begin(), values.end(), [](const auto& v) { return v.has_value(); }));
    EXPECT_EQ(count_of(svg, "data-segment="), 17u) << kind.name;
    EXPECT_EQ(count_of(svg, "<path"), present + 17) << kind.name;
    EXPECT_EQ(svg.find("nan"), std::string::npos) << kind.name;
    EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n");
  }
  EXPECT_NE(polar_svg(m, polar_kinds()[1]).find("(apparent)"), std::string::npos);
}

TEST(PolarPicture, IsEmptyWithoutABeat) {
  const ventricle::Result result = test::sample_ungated();
  const ventricle::Measures& m = *result.measures;
  EXPECT_TRUE(m.maps.motion_mm.empty());
  EXPECT_EQ(phase_histogram_svg(m), "");
  EXPECT_EQ(count_of(polar_svg(m, polar_kinds()[5]), "<path"), 17u);
}

TEST(PhasePicture, ShowsBothHistograms) {
  const std::string svg = phase_histogram_svg(*sample().measures);
  EXPECT_NE(svg.find("Onset by counts"), std::string::npos);
  EXPECT_NE(svg.find("Onset by motion"), std::string::npos);
}

}  // namespace
}  // namespace dynasurf::report
