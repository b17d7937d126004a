#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dynasurf/report/detail/page_pictures.hpp"
#include "dynasurf/report/detail/page_template.hpp"

#include "support/sample_result.hpp"
#include "texts.hpp"

namespace dynasurf::report {
namespace {

using nlohmann::ordered_json;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const ventricle::Result& ok_result() {
  static const ventricle::Result result = test::sample_result();
  return result;
}

ordered_json ok_json() { return results_json(ok_result(), test::sample_provenance()); }

std::string ok_page() { return report_html(ok_result(), test::sample_provenance()); }

/// The JSON that a page carries.
ordered_json data_of(const std::string& page) {
  const std::string begin = R"(<script type="application/json" id="data">)";
  const std::size_t from = page.find(begin) + begin.size();
  return ordered_json::parse(page.substr(from, page.find("</script>", from) - from));
}

TEST(Results, HoldTheNumbersOfTheResult) {
  const ordered_json json = ok_json();
  EXPECT_EQ(json["schema"], "dynasurf.ventricle/3");
  EXPECT_EQ(json["edv_ml"], ok_result().leading.edv_ml->value);
  EXPECT_EQ(json["esv_ml"], ok_result().leading.esv_ml->value);
  EXPECT_EQ(json["sv_ml"], ok_result().leading.sv_ml->value);
  EXPECT_EQ(json["ef_percent"], ok_result().leading.ef_percent->value);
  EXPECT_EQ(json["quality"]["verdict"], "ok");
  ASSERT_EQ(json["gates"].size(), 8u);
  const ordered_json& gate = json["gates"][2];
  EXPECT_EQ(gate["time_ms"], 220);
  EXPECT_EQ(gate["endo_ml"], ok_result().gates[2].edge_surfaces.endo->volume_ml);
  EXPECT_EQ(gate["wall_ml"], *ok_result().gates[2].edge_surfaces.wall_ml);
  EXPECT_EQ(gate["edge"]["endo"]["stop_reason"], "all_stopped");
  EXPECT_EQ(gate["edge"]["epi"]["triangles"]["count"], 1280);
}

TEST(Results, SayTheNumberOfTheLeadingReadingAtTheTop) {
  const ventricle::Result fitted = test::sample_fitted();
  const ordered_json json = results_json(fitted, {});
  EXPECT_EQ(json["reading"], "psf_corrected");
  for (const char* key :
       {"edv_ml", "edv_ml_90", "esv_ml", "sv_ml", "ef_percent", "ef_percent_90", "wall_ml", "ed_gate"})
    EXPECT_EQ(json[key], json["readings"]["psf_corrected"][key]) << key;
  EXPECT_NE(json["edv_ml"], json["readings"]["edge"]["edv_ml"]);
  const ordered_json& gate = json["gates"][0];
  EXPECT_EQ(gate["endo_ml"], fitted.readings.psf_corrected->gates[0].endo_ml.value);
  EXPECT_EQ(gate["edge"]["endo_ml"], fitted.gates[0].edge_surfaces.endo->volume_ml);
  EXPECT_EQ(ok_json()["reading"], "edge");
  EXPECT_TRUE(ok_json()["edv_ml_90"].is_null()) << "the edge has no interval";
}

TEST(Results, CountGatesAndSlicesFromOne) {
  const ordered_json json = ok_json();
  EXPECT_EQ(json["ed_gate"], *ok_result().leading.ed_gate + 1);
  EXPECT_EQ(json["es_gate"], *ok_result().leading.es_gate + 1);
  EXPECT_EQ(json["gates"][0]["gate"], 1);
  EXPECT_EQ(json["gates"][0]["division_slice"], 5);
  EXPECT_EQ(json["notes"][0]["gate"], 1);
  EXPECT_EQ(json["notes"][0]["slice"], 5);
}

TEST(Results, GiveTheWorseOfTheTwoSurfacesAsTheNumberOfTheGate) {
  ventricle::Result result = ok_result();
  result.gates[0].edge_surfaces.endo->stopped_fraction = 0.5;
  result.gates[0].edge_surfaces.epi->mean_distance_mm = 9;
  const ordered_json gate = results_json(result, {})["gates"][0]["edge"];
  EXPECT_EQ(gate["stopped_fraction"], 0.5);
  EXPECT_EQ(gate["mean_distance_mm"], 9);
}

TEST(Results, AreNullWhereSomethingIsAbsentOrNotANumber) {
  ventricle::Result result = test::sample_without_endo();
  result.gates[1].edge_surfaces.epi->mean_distance_mm = std::numeric_limits<double>::infinity();
  result.gates[1].edge_surfaces.epi->quality.shape_min = std::numeric_limits<double>::quiet_NaN();
  const ordered_json json = results_json(result, {});
  EXPECT_TRUE(json["ef_percent"].is_null());
  EXPECT_TRUE(json["ed_gate"].is_null());
  EXPECT_TRUE(json["gates"][0]["edge"]["endo"].is_null());
  EXPECT_TRUE(json["gates"][0]["wall_ml"].is_null());
  EXPECT_TRUE(json["gates"][1]["edge"]["mean_distance_mm"].is_null());
  EXPECT_TRUE(json["gates"][1]["edge"]["epi"]["triangles"]["shape_min"].is_null());
  EXPECT_TRUE(json["provenance"]["options"].is_null());
  EXPECT_TRUE(json["provenance"]["seed"].is_null());
}

TEST(Results, LoseNoNoteOfStudyOrLabelsAndDoubleNone) {
  ventricle::Result result = test::sample_failed();
  result.study.notes = {{Severity::warning, "dicom.time", "the R-R interval is not given"}};
  result.notes.push_back(result.study.notes[0]);
  const ordered_json notes = results_json(result, {})["notes"];
  // One of the sample, the study's once, and one per gate from its labels.
  ASSERT_EQ(notes.size(), 10u);
  EXPECT_EQ(notes[1]["code"], "dicom.time");
  EXPECT_EQ(notes[9]["code"], "labels.no_circle");
  EXPECT_EQ(notes[9]["gate"], 8);
  EXPECT_EQ(notes[9]["severity"], "failure");
}

TEST(Results, CarryTheirProvenanceWithTheOptionsAsJson) {
  Provenance provenance = test::sample_provenance();
  provenance.seed = 42;
  const ordered_json json = results_json(ok_result(), provenance)["provenance"];
  EXPECT_EQ(json["version"], "0.1.0");
  EXPECT_EQ(json["inputs"][0]["file"], "patient.dcm");
  EXPECT_EQ(json["seed"], 42);
  EXPECT_EQ(json["options"]["edges"]["sigma_px"], 1.8);
}

TEST(Results, DifferBetweenRunsInTheirTimingsOnly) {
  ventricle::Result slower = ok_result();
  for (auto& [stage, seconds] : slower.seconds) seconds *= 2;
  const Provenance provenance = test::sample_provenance();
  EXPECT_NE(results_json(ok_result(), provenance).dump(), results_json(slower, provenance).dump());
  EXPECT_EQ(results_json(ok_result(), provenance, Timings::omit).dump(),
            results_json(slower, provenance, Timings::omit).dump());
  EXPECT_EQ(report_html(ok_result(), provenance, Timings::omit), report_html(slower, provenance, Timings::omit));
  EXPECT_EQ(ok_json()["timings_s"]["field"], 0.611);
}

TEST(Results, RefuseOptionsThatAreNotJson) {
  Provenance provenance;
  provenance.options_json = "sigma = 3";
  EXPECT_THROW(results_json(ok_result(), provenance), OptionError);
}

TEST(Csv, HasOneRowPerGateAndAsManyFieldsAsNames) {
  const std::vector<std::string> lines = lines_of(results_csv(ok_result()));
  ASSERT_EQ(lines.size(), 9u);
  EXPECT_THAT(lines[0], StartsWith("gate,time_ms,endo_ml,endo_ml_low,endo_ml_high,epi_ml,"));
  EXPECT_THAT(lines[3], StartsWith("3,220,"));
  for (const std::string& line : lines)
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), std::count(lines[0].begin(), lines[0].end(), ','));
}

TEST(Csv, GivesBackTheVolumesExactly) {
  const std::string line = lines_of(results_csv(ok_result()))[1];
  std::istringstream fields(line);
  std::string field;
  for (int n = 0; n < 3; ++n) std::getline(fields, field, ',');
  EXPECT_EQ(std::stod(field), ok_result().gates[0].edge_surfaces.endo->volume_ml);
}

TEST(Csv, LeavesAbsentValuesEmpty) {
  const std::vector<std::string> lines = lines_of(results_csv(test::sample_failed()));
  ASSERT_EQ(lines.size(), 9u);
  EXPECT_THAT(lines[1], StartsWith("1,0,,,,"));
}

TEST(Page, MayLoadNothing) {
  const std::string page = ok_page();
  EXPECT_THAT(page,
              HasSubstr(R"(http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'sha256-)"));
  EXPECT_THAT(page, Not(HasSubstr("unsafe-")));
  for (const char* load : {"src=\"http", "src='http", "href=\"http", "url(http", "@import", "<link", "<iframe"})
    EXPECT_THAT(page, Not(HasSubstr(load))) << load;
}

TEST(Page, SaysThatItIsForResearchOnly) { EXPECT_THAT(ok_page(), HasSubstr("Research use only. Not for diagnosis.")); }

TEST(Page, StaysBelowFiveMegabytes) { EXPECT_LE(ok_page().size(), 5'000'000u); }

TEST(Page, HasOnePlaceForItsData) {
  const std::string_view page = page_template();
  const std::size_t at = page.find("{{DATA}}");
  ASSERT_NE(at, std::string_view::npos);
  EXPECT_EQ(page.find("{{DATA}}", at + 1), std::string_view::npos);
  EXPECT_THAT(ok_page(), Not(HasSubstr("{{")));
}

TEST(Page, CarriesTheResultsAndASurfacePerGateAndWall) {
  const ordered_json data = data_of(ok_page());
  EXPECT_EQ(data["results"], ok_json());
  EXPECT_EQ(data["surfaces"]["endo"].size(), 8u);
  EXPECT_EQ(data["surfaces"]["triangles"].size(), 1u) << "all surfaces share their triangles";
  // 642 vertices, three coordinates of two bytes each, four characters for three bytes.
  EXPECT_EQ(data["surfaces"]["epi"][7]["positions"].get<std::string>().size(), 642u * 6 / 3 * 4);
  EXPECT_EQ(data["pictures"]["columns"], 64);
  EXPECT_EQ(data["pictures"]["labels"].size(), 8u);
}

TEST(Page, KeepsTextFromFilesOutOfItsMarkup) {
  ventricle::Result result = ok_result();
  result.notes[0].message = "</script><script>alert(1)</script><!--";
  const std::string page = report_html(result, test::sample_provenance());
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_EQ(data_of(page)["results"]["notes"][0]["message"], result.notes[0].message);
}

TEST(Page, SurvivesTextThatIsNotUtf8) {
  ventricle::Result result = ok_result();
  result.notes[0].message = "caf\xe9";
  EXPECT_THAT(report_html(result, test::sample_provenance()), HasSubstr("caf"));
}

TEST(Page, ShowsAFailedStudyWithItsImagesAndWithoutSurfaces) {
  const ordered_json data = data_of(report_html(test::sample_failed(), test::sample_provenance()));
  EXPECT_TRUE(data["surfaces"].is_null());
  EXPECT_EQ(data["results"]["quality"]["flags"].size(), 2u);
  EXPECT_EQ(data["pictures"]["pixels"], data_of(ok_page())["pictures"]["pixels"]);
}

TEST(Page, ShowsTheEdgesThatExplainAFailure) {
  ventricle::Result result = test::sample_failed();
  const ordered_json with = data_of(report_html(result, {}))["pictures"]["marks"];
  for (ventricle::Gate& gate : result.gates) gate.edges = {};
  EXPECT_NE(with, data_of(report_html(result, {}))["pictures"]["marks"]);
}

TEST(Page, ShowsAStudyThatIsNotGated) {
  const ordered_json data = data_of(report_html(test::sample_ungated(), test::sample_provenance()));
  EXPECT_EQ(data["results"]["study"]["gates"], 1);
  EXPECT_TRUE(data["results"]["ef_percent"].is_null());
  EXPECT_FALSE(data["surfaces"]["endo"][0].is_null());
}

TEST(Page, BinsTheSlicesOfAStudyThatWouldNotFit) {
  ventricle::Result result;
  Grid grid;
  grid.dims = {400, 400, 301};  // 48.2 million voxels
  result.study.gates.emplace_back(grid, 0.5f);
  const ordered_json pictures = data_of(report_html(result, {}))["pictures"];
  EXPECT_EQ(pictures["bin"], 2);
  EXPECT_EQ(pictures["columns"], 200);
}

TEST(Pictures, AverageThePixelsOfABin) {
  Study study;
  Grid grid;
  grid.dims = {7, 5, 2};
  for (int g = 0; g < 2; ++g) {
    Image& gate = study.gates.emplace_back(grid);
    for (std::size_t v = 0; v < grid.size(); ++v) gate.values[v] = static_cast<float>((v * 37 + g * 11) % 101) - 20;
  }
  study.gates[0](6, 4, 0) = std::numeric_limits<float>::infinity();
  study.gates[1](0, 0, 1) = 250;
  for (const int bin : {1, 2, 3, 8}) {
    detail::Bytes means;
    for (const Image& gate : study.gates)
      for (int k = 0; k < 2; ++k)
        for (int j0 = 0; j0 < 5; j0 += bin)
          for (int i0 = 0; i0 < 7; i0 += bin) {
            double sum = 0, count = 0;
            for (int j = j0; j < std::min(j0 + bin, 5); ++j)
              for (int i = i0; i < std::min(i0 + bin, 7); ++i) {
                sum += std::isfinite(gate(i, j, k)) ? gate(i, j, k) : 0;
                ++count;
              }
            means.push_back(static_cast<std::uint8_t>(std::clamp(std::round(sum / count * (255.0 / 250)), 0.0, 255.0)));
          }
    EXPECT_EQ(detail::image_bytes(study, bin), means) << bin;
  }
}

TEST(Pictures, JoinTheMarksOfABin) {
  Grid grid;
  grid.dims = {7, 5, 2};
  Mask borders(grid), edges(grid);
  for (std::size_t v = 0; v < grid.size(); ++v)
    borders.values[v] = v % 11 == 0 ? v % 3 : 0, edges.values[v] = v % 13 == 4 ? 1 + v % 2 : 0;
  for (const int bin : {1, 2, 3, 8}) {
    const int columns = (7 + bin - 1) / bin, rows = (5 + bin - 1) / bin;
    detail::Bytes joined(static_cast<std::size_t>(columns * rows * 2), 0);
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j < 5; ++j)
        for (int i = 0; i < 7; ++i) {
          const unsigned marks = borders(i, j, k) | (edges(i, j, k) == 0 ? 0u : 2u << edges(i, j, k));
          joined[static_cast<std::size_t>((k * rows + j / bin) * columns + i / bin)] |=
              static_cast<std::uint8_t>(marks);
        }
    EXPECT_EQ(detail::mark_bytes(grid, borders, edges, bin), joined) << bin;
    EXPECT_EQ(detail::mark_bytes(grid, {}, {}, bin), detail::Bytes(joined.size(), 0)) << bin;
  }
}

TEST(Page, IsWrittenForAResultWithoutAnyImage) {
  const ordered_json data = data_of(report_html(ventricle::Result{}, {}));
  EXPECT_TRUE(data["pictures"].is_null());
  EXPECT_TRUE(data["results"]["study"]["dims"].is_null());
  EXPECT_EQ(data["results"]["quality"]["verdict"], "fail");
}

TEST(Page, IsWrittenToAFileAsItIs) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "report_test.html";
  write_report(ok_result(), test::sample_provenance(), path);
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content << file.rdbuf();
  EXPECT_EQ(content.str(), ok_page());
  std::filesystem::remove(path);
}

TEST(Page, CannotBeWrittenBelowAFile) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "report_test_in_the_way";
  std::ofstream(file) << "a file";
  EXPECT_THROW(write_report(ok_result(), {}, file / "report.html"), IoError);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace dynasurf::report
