#include "dynasurf/ventricle/detail/quality.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf::ventricle {
namespace {

Result good_result() {
  Result result;
  for (int g = 0; g < 8; ++g) {
    Gate gate;
    gate.gate = g;
    gate.edge_surfaces.endo.emplace();
    gate.edge_surfaces.epi.emplace();
    gate.edge_surfaces.endo->within_one_voxel = gate.edge_surfaces.epi->within_one_voxel = 1;
    gate.edge_surfaces.endo->border_reached = gate.edge_surfaces.epi->border_reached = 1;
    gate.edge_surfaces.endo->stop_reason = gate.edge_surfaces.epi->stop_reason = dynamics::StopReason::all_stopped;
    gate.edge_surfaces.endo->repair.check = gate.edge_surfaces.epi->repair.check = {true, true, true, 0, 0};
    gate.edge_surfaces.wall_ml = 120;
    result.gates.push_back(gate);
  }
  result.heart.emplace();
  result.heart->cup = {{0, 0, 0}, {0, 0, 1}, 30, 45, 25};
  result.heart->contrast = 0.6, result.heart->ridge_share = 0.95, result.heart->other_end = 0.5;
  result.readings.edge.edv_ml = heart::Estimate{110}, result.readings.edge.esv_ml = heart::Estimate{44};
  result.readings.edge.ef_percent = heart::Estimate{60}, result.wall_variation = 0.08;
  result.leading = result.readings.edge;
  return result;
}

std::vector<std::string> codes_of(const Result& result) {
  std::vector<std::string> codes;
  for (const QualityFlag& flag : assess(result)) codes.push_back(flag.code);
  return codes;
}
using Codes = std::vector<std::string>;

TEST(Judge, FindsNothingInAGoodResult) {
  EXPECT_EQ(codes_of(good_result()), Codes{});
  EXPECT_EQ(verdict_of({}), Verdict::ok);
}

TEST(Judge, FailsWhenASurfaceIsMissingAndNamesTheGates) {
  Result result = good_result();
  result.gates[2].edge_surfaces.endo.reset();
  result.gates[5].edge_surfaces.endo.reset();
  const std::vector<QualityFlag> flags = assess(result);
  ASSERT_EQ(flags.size(), 1U);
  EXPECT_EQ(flags[0].code, "surface_missing");
  EXPECT_EQ(flags[0].message, "no endocardial border was found in gates 3, 6");
  EXPECT_EQ(flags[0].value, 2);
  EXPECT_EQ(verdict_of(flags), Verdict::fail);
}

TEST(Judge, AsksToCheckWhereTheFitWentWithoutASurface) {
  Result result = good_result();
  result.gates[2].edge_surfaces.endo.reset();
  result.readings.psf_corrected.emplace();
  const std::vector<QualityFlag> flags = assess(result);
  ASSERT_FALSE(flags.empty());
  EXPECT_EQ(flags[0].code, "surface_missing");
  EXPECT_EQ(verdict_of(flags), Verdict::check);
}

TEST(Judge, TellsAMissingSurfaceOnce) {
  Result result = good_result();
  result.gates[2].edge_surfaces.endo.reset();
  result.notes.push_back({Severity::failure, "labels.no_endo", "The endo border was found in no slice.", 2});
  EXPECT_EQ(codes_of(result), Codes{"surface_missing"});
}

TEST(Judge, AsksToCheckASurfaceThatLiesOnAPartOfItsBorderOnly) {
  // All particles lie on the border, but the open base of a cavity that was grown from inside was never reached.
  Result result = good_result();
  result.gates[3].edge_surfaces.endo->border_reached = 0.6;
  EXPECT_EQ(codes_of(result), Codes{"border_unreached"});
  EXPECT_EQ(verdict_of(assess(result)), Verdict::check);
}

TEST(Judge, AsksToCheckWhatAHeartDoesNotDo) {
  Result result = good_result();
  result.wall_variation = 0.3;
  result.leading.ef_percent = heart::Estimate{90};
  result.leading.edv_ml = heart::Estimate{900};
  result.gates[0].edge_surfaces.epi->within_one_voxel = 0.5;
  EXPECT_EQ(codes_of(result),
            (Codes{"surface_incomplete", "wall_volume_varies", "ejection_fraction_implausible", "volume_implausible"}));
  EXPECT_EQ(verdict_of(assess(result)), Verdict::check);
}

TEST(Judge, FailsForNumbersThatNoHeartHas) {
  Result result = good_result();
  result.leading.ef_percent = heart::Estimate{99.8};
  EXPECT_EQ(codes_of(result), Codes{"ejection_fraction_implausible"});
  EXPECT_EQ(verdict_of(assess(result)), Verdict::fail);
  result = good_result();
  result.leading.edv_ml = heart::Estimate{2324};
  EXPECT_EQ(codes_of(result), Codes{"volume_implausible"});
  EXPECT_EQ(verdict_of(assess(result)), Verdict::fail);
}

TEST(Judge, JudgesTheNumbersThatLead) {
  Result result = good_result();
  result.readings.edge.ef_percent = heart::Estimate{99}, result.readings.edge.edv_ml = heart::Estimate{9};
  EXPECT_EQ(codes_of(result), Codes{}) << "blur does this to the edges of a small heart";
}

TEST(Judge, FailsWhenTheWallsCrossOrASurfaceDiverged) {
  Result result = good_result();
  result.gates[3].edge_surfaces.wall_ml = -2;
  result.gates[4].edge_surfaces.epi->stop_reason = dynamics::StopReason::diverged;
  EXPECT_EQ(codes_of(result), (Codes{"surface_diverged", "walls_cross"}));
  EXPECT_EQ(verdict_of(assess(result)), Verdict::fail);
}

TEST(Judge, AsksToCheckASurfaceThatIsNotFitToPublish) {
  Result result = good_result();
  result.gates[1].edge_surfaces.epi->repair.check.self_intersections = 3;
  result.gates[6].edge_surfaces.endo->repair.check.closed = false;
  const std::vector<QualityFlag> flags = assess(result);
  ASSERT_EQ(flags.size(), 1U);
  EXPECT_EQ(flags[0].code, "surface_invalid");
  EXPECT_EQ(flags[0].value, 2);
  EXPECT_EQ(verdict_of(flags), Verdict::check);
}

TEST(Judge, TurnsWarningsOfTheStagesIntoOneFlagPerCode) {
  Result result = good_result();
  result.notes.push_back({Severity::info, "gvf.step_limited", "the step was shortened", 0});
  result.notes.push_back({Severity::warning, "slice_refine.case_4", "the slices disagree", 1});
  result.notes.push_back({Severity::warning, "slice_refine.case_4", "the slices disagree", 3});
  const std::vector<QualityFlag> flags = assess(result);
  ASSERT_EQ(flags.size(), 1U);
  EXPECT_EQ(flags[0].code, "slice_refine.case_4");
  EXPECT_EQ(flags[0].message, "the slices disagree (gates 2, 4)");
  EXPECT_EQ(flags[0].value, 2);
}

TEST(Judge, AsksToCheckWhereTheHeartWasHardlySeen) {
  Result result = good_result();
  result.heart->contrast = 0.1;
  result.heart->other_end = 0.99;
  EXPECT_EQ(codes_of(result), (Codes{"heart_uncertain", "ends_uncertain"}));
  EXPECT_EQ(assess(result)[0].value, 0.1);
  result.heart.reset();
  EXPECT_EQ(codes_of(result), Codes{"heart_not_found"});
}

TEST(Judge, AsksToCheckASurfaceThatLiesBesideTheHeart) {
  Result result = good_result();
  for (Gate& gate : result.gates) gate.edge_surfaces.epi->mesh.vertices = {{0, 0, -12}, {2, 0, -8}};
  EXPECT_EQ(codes_of(result), Codes{}) << "the heart's middle is at (0, 0, -10)";
  result.gates[6].edge_surfaces.epi->mesh.vertices = {{30, 0, -10}};
  EXPECT_EQ(codes_of(result), (Codes{"surface_off_heart", "heart_moves"}));
}

TEST(Judge, DoubtsASurfaceThatLiesAsideInOneGateOnlyWhereEdgesLead) {
  Result result = good_result();
  for (Gate& gate : result.gates) gate.edge_surfaces.epi->mesh.vertices = {{0, 0, -10}};
  result.gates[6].edge_surfaces.epi->mesh.vertices = {{6, 0, -10}};
  EXPECT_EQ(codes_of(result), Codes{"heart_moves"});
  EXPECT_EQ(verdict_of(assess(result)), Verdict::check);
  result.leading.ef_percent = heart::Estimate{60, 2};
  EXPECT_EQ(codes_of(result), Codes{"heart_moves"});
  EXPECT_EQ(verdict_of(assess(result)), Verdict::ok);
}

TEST(Judge, AsksToCheckAHeartThatIsNotAllInTheVolumeOrTooLong) {
  Result result = good_result();
  result.heart->outside = 0.2;
  result.heart->cup.half_length_mm = 90;
  EXPECT_EQ(codes_of(result), (Codes{"heart_cut_off", "shape_implausible"}));
  EXPECT_EQ(assess(result)[0].value, 0.2);
  EXPECT_NEAR(assess(result)[1].value, 3, 1e-12);
}

TEST(Judge, AsksToCheckGatesInTheWrongOrder) {
  Result result = good_result();
  result.readings.edge.ed_gate = 0, result.readings.edge.es_gate = 3;
  EXPECT_EQ(codes_of(result), Codes{});
  result.readings.edge.es_gate = 6;
  EXPECT_EQ(codes_of(result), Codes{"end_systole_implausible"});
}

TEST(Judge, AsksToCheckABaseThatWasHardlySeen) {
  Result result = good_result();
  for (Gate& gate : result.gates) gate.edge_surfaces.base_plane = heart::BasePlane{{0, 0, 25}, {0, 0, 1}, 1.0, 0.9};
  EXPECT_EQ(codes_of(result), Codes{});
  for (Gate& gate : result.gates) gate.edge_surfaces.base_plane->spread_mm = 9;
  EXPECT_EQ(codes_of(result), Codes{"base_uncertain"});
  for (Gate& gate : result.gates)
    gate.edge_surfaces.base_plane->spread_mm = 1, gate.edge_surfaces.base_plane->cut = 0.5;
  EXPECT_EQ(codes_of(result), Codes{"base_cut_off"});
}

TEST(Judge, AsksToCheckGatesThatDoNotFitTogether) {
  Result result = good_result();
  Grid grid;
  grid.dims = {2, 2, 2};
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    result.gates[g].edge_surfaces.endo->volume_ml = g == 3 ? 20 : 80;
    result.study.gates.push_back(Image(grid, g == 7 ? 0.7F : 1.0F));
  }
  EXPECT_EQ(codes_of(result), (Codes{"counts_uneven", "curve_rough"}));
}

TEST(Judge, ListsUncertainDivisionSlicesWithoutDoubtingTheResult) {
  Result result = good_result();
  result.notes.push_back({Severity::warning, "slice_refine.case_2", "unlikely", 0, 3});
  EXPECT_EQ(codes_of(result), Codes{"slice_refine.case_2"});
  EXPECT_EQ(verdict_of(assess(result)), Verdict::ok);
}

TEST(Judge, AsksToCheckABorderThatIsMissingInManySlices) {
  Result result = good_result();
  for (int g = 0; g < 8; ++g)
    for (int k = 0; k < 3; ++k) result.notes.push_back({Severity::warning, "labels.endo_missing", "absent", g, k});
  EXPECT_EQ(verdict_of(assess(result)), Verdict::check);
  EXPECT_EQ(codes_of(result).front(), "border_missing");
}

/// Both surfaces of every gate as points on spheroids around the heart's axis, with the volumes of these.
void give_shape(Result& result, double epi_radius, double epi_half_length, double endo_radius) {
  for (Gate& gate : result.gates) {
    const auto spheroid = [](Surface& surface, double radius, double half_length) {
      for (int n = 0; n < 400; ++n) {
        const double theta = std::numbers::pi * (n / 20 + 0.5) / 20, phi = 2 * std::numbers::pi * (n % 20) / 20;
        surface.mesh.vertices.emplace_back(radius * std::sin(theta) * std::cos(phi),
                                           radius * std::sin(theta) * std::sin(phi), half_length * std::cos(theta));
      }
      surface.volume_ml = 4 * std::numbers::pi / 3 * radius * radius * half_length / 1000;
    };
    spheroid(*gate.edge_surfaces.epi, epi_radius, epi_half_length);
    spheroid(*gate.edge_surfaces.endo, endo_radius, endo_radius * epi_half_length / epi_radius);
  }
}

TEST(Judge, AsksToCheckAHeartThatThickSlicesStretched) {
  Result result = good_result();
  result.heart->cup = {{0, 0, 0}, {0, 0, 1}, 30, 40, 25};
  give_shape(result, 35, 45, 23);
  EXPECT_EQ(codes_of(result), Codes{});
  for (Gate& gate : result.gates)
    for (Surface* surface : {&*gate.edge_surfaces.endo, &*gate.edge_surfaces.epi}) {
      for (Vec3& p : surface->mesh.vertices) p[2] *= 1.8;
      surface->volume_ml *= 1.8;
    }
  const std::vector<QualityFlag> flags = assess(result);
  ASSERT_FALSE(flags.empty());
  const auto found =
      std::find_if(flags.begin(), flags.end(), [](const QualityFlag& f) { return f.code == "shape_implausible"; });
  ASSERT_NE(found, flags.end());
  EXPECT_NEAR(found->value, 1.8 * 45 / 35, 0.05) << "the outermost points lie a little inside the ends";
}

bool is_flagged(const Result& result, const std::string& code) {
  const Codes codes = codes_of(result);
  return std::find(codes.begin(), codes.end(), code) != codes.end();
}

std::optional<Severity> doubt_of(const Result& result, const std::string& code) {
  for (const QualityFlag& flag : assess(result))
    if (flag.code == code) return flag.severity;
  return {};
}

TEST(Judge, DoubtsSurfacesBesideTheHeartThatLead) {
  Result result = good_result();
  for (Gate& gate : result.gates) gate.edge_surfaces.epi->mesh.vertices = {{9, 0, -10}};
  EXPECT_EQ(doubt_of(result, "surface_off_heart"), Severity::warning);
  result.leading.ef_percent = heart::Estimate{60, 2};
  result.readings.psf_corrected.emplace().gates.resize(8);
  result.readings.psf_corrected->gates[3].epi.vertices = {{7, 0, -10}};
  EXPECT_EQ(doubt_of(result, "surface_off_heart"), Severity::info) << "the fit lies on the heart";
  result.readings.psf_corrected->gates[3].epi.vertices = {{9, 0, -10}};
  EXPECT_EQ(doubt_of(result, "surface_off_heart"), Severity::warning);
}

TEST(Judge, BearsRougherEdgesBesideAFit) {
  const auto result_of = [](double jump_ml, double spread_mm) {
    Result result = good_result();
    for (int g = 0; g < 8; ++g) {
      result.gates[g].edge_surfaces.endo->volume_ml = g == 3 ? 100 - jump_ml : 100;
      result.gates[g].edge_surfaces.base_plane = heart::BasePlane{{0, 0, 25}, {0, 0, 1}, spread_mm, 1};
    }
    return result;
  };
  for (const bool is_fitted : {false, true}) {
    Result little = result_of(40, 5), much = result_of(60, 7);
    if (is_fitted)
      for (Result* r : {&little, &much}) r->leading.ef_percent = heart::Estimate{60, 2};
    for (const char* code : {"curve_rough", "base_uncertain"}) {
      EXPECT_EQ(doubt_of(little, code), is_fitted ? Severity::info : Severity::warning) << code;
      EXPECT_EQ(doubt_of(much, code), Severity::warning) << code;
    }
  }
}

/// Gates of a ventricle as hot as 1 beside a liver of half of that, the ventricle moved aside in some of them.
std::vector<Image> gates_of_a_beat(const std::vector<double>& aside_mm, float background = 0.05F) {
  Grid grid{{32, 32, 32}};
  grid.spacing = Vec3::Constant(5), grid.origin = Vec3::Constant(-77.5);
  std::vector<Image> gates;
  for (std::size_t g = 0; g < aside_mm.size(); ++g) {
    const double narrower = 1 - 0.15 * std::sin(std::numbers::pi * g / aside_mm.size());
    Image image(grid, background);
    std::size_t voxel = 0;
    for (int k = 0; k < 32; ++k)
      for (int j = 0; j < 32; ++j)
        for (int i = 0; i < 32; ++i, ++voxel) {
          const Vec3 p = grid.origin + 5 * Vec3(i, j, k);
          const double q = (p - Vec3(aside_mm[g], 0, 0)).cwiseQuotient(narrower * Vec3(35, 35, 45)).norm();
          if (q > 0.65 && q < 1 && p[2] < 25)
            image.values[voxel] = 1;
          else if (p[1] < -45)
            image.values[voxel] = 0.5F;
        }
    gates.push_back(std::move(image));
  }
  return gates;
}

TEST(Judge, AsksToCheckAPatientWhoMoved) {
  Result result = good_result();
  result.leading.ef_percent = heart::Estimate{60, 2};
  result.study.gates = gates_of_a_beat(std::vector<double>(8, 0.0));
  EXPECT_FALSE(is_flagged(result, "heart_moves")) << "a beat is no move";
  result.study.gates = gates_of_a_beat({0, 0, 15, 15, 15, 15, 0, 0});
  EXPECT_EQ(doubt_of(result, "heart_moves"), Severity::warning) << "whatever leads";
  result.study.gates = gates_of_a_beat({0, 0, 10, 10, 10, 10, 0, 0}, 0.45F);
  EXPECT_EQ(doubt_of(result, "heart_moves"), Severity::warning) << "in a bright background too";
}

TEST(Judge, AsksToCheckWhatTwoReadingsDisagreeAbout) {
  Result result = good_result();
  result.readings.gaussian_profile = {{110, 95, 70, 44, 55, 75, 90, 105}, {}};
  EXPECT_FALSE(is_flagged(result, "readings_disagree"));
  result.readings.gaussian_profile->cavity_ml[3] = 44 - 0.21 * 110;  // 21 points more
  EXPECT_TRUE(is_flagged(result, "readings_disagree"));
}

TEST(Judge, AsksToCheckASmallHeartOfWhichMuchOfTheWallIsNotSeen) {
  Result result = good_result();
  result.heart->cup = {{0, 0, 0}, {0, 0, 1}, 30, 40, 25};
  give_shape(result, 35, 45, 23);  // a wall of some 13 mm around a cavity of the volume of a ball of 25 mm
  result.heart->ridge_share = 0.9;
  EXPECT_FALSE(is_flagged(result, "wall_missing"));
  result.heart->ridge_share = 0.8;  // 0.2 13 / 25
  EXPECT_TRUE(is_flagged(result, "wall_missing"));
  for (Gate& gate : result.gates)
    gate.edge_surfaces.endo->volume_ml *= 8;  // twice as wide: the same hole matters half as much
  EXPECT_FALSE(is_flagged(result, "wall_missing"));
}

TEST(Judge, BelievesAFitOfWhatEdgesCannotTell) {
  Result result = good_result();
  result.heart->cup = {{0, 0, 0}, {0, 0, 1}, 30, 40, 25};
  give_shape(result, 35, 45, 23);
  result.heart->ridge_share = 0.8;
  result.readings.gaussian_profile = {{110, 95, 70, 20, 55, 75, 90, 105}, {}};
  for (Gate& gate : result.gates)
    gate.edge_surfaces.epi->within_one_voxel = 0.9, gate.edge_surfaces.epi->border_reached = 0.9;
  result.wall_variation = 0.3;
  const Codes doubts = codes_of(result);
  for (const char* code :
       {"surface_incomplete", "border_unreached", "wall_missing", "wall_volume_varies", "readings_disagree"})
    EXPECT_TRUE(is_flagged(result, code)) << code;
  EXPECT_EQ(verdict_of(assess(result)), Verdict::check);
  result.leading.ef_percent = heart::Estimate{60, 4};
  EXPECT_EQ(codes_of(result), doubts) << "readers are still told";
  EXPECT_EQ(verdict_of(assess(result)), Verdict::ok);
}

TEST(Judge, AsksToCheckAWallThatIsThickToEdgesAndToTheFit) {
  const auto doubt = [](double epi_radius, double endo_radius, double fitted_mm) -> std::optional<Severity> {
    Result result = good_result();
    result.heart->cup = {{0, 0, 0}, {0, 0, 1}, 30, 40, 25};
    give_shape(result, epi_radius, 1.2 * epi_radius, endo_radius);
    result.leading.ef_percent = heart::Estimate{60, 4};
    result.readings.psf_corrected.emplace().thickness_mm.value = fitted_mm;
    return doubt_of(result, "thickness_implausible");
  };
  EXPECT_EQ(doubt(38, 25, 9), std::nullopt);
  EXPECT_EQ(doubt(45, 23, 7), Severity::info) << "edges behind a wide point spread";
  EXPECT_EQ(doubt(45, 23, 16), Severity::warning) << "pixels that are said to be too large";
  EXPECT_EQ(doubt(30, 25, 7), Severity::warning) << "pixels that are said to be too small";
}

TEST(Judge, AsksToCheckAnIntervalAsWideAsAWrongReading) {
  Result result = good_result();
  result.leading.ef_percent = heart::Estimate{60, 4.8};  // 90 % within 7.9 points
  result.leading.edv_ml = heart::Estimate{100, 9};       // and 14.8 %
  EXPECT_EQ(codes_of(result), Codes{});
  result.leading.ef_percent->sd = 5;
  EXPECT_EQ(codes_of(result), Codes{"ef_uncertain"});
  result.leading.edv_ml->sd = 9.3;
  EXPECT_EQ(codes_of(result), (Codes{"ef_uncertain", "edv_uncertain"}));
  EXPECT_EQ(verdict_of(assess(result)), Verdict::check);
}

TEST(Judge, DoubtsABorderThatIsNotRoundOnlyWhereEdgesLead) {
  Result result = good_result();
  result.heart->cup = {{0, 0, 0}, {0, 0, 1}, 30, 40, 25};
  give_shape(result, 38, 48, 25);
  const auto doubt = [&] { return doubt_of(result, "section_not_round"); };
  EXPECT_EQ(doubt(), std::nullopt);
  for (Gate& gate : result.gates)
    for (Vec3& p : gate.edge_surfaces.epi->mesh.vertices) p[0] *= 1.5;
  EXPECT_EQ(doubt(), Severity::warning);
  result.leading.ef_percent = heart::Estimate{60, 2};
  EXPECT_EQ(doubt(), Severity::info);
}

TEST(Judge, DoubtsEdgesThatFollowOtherGatesOnlyWhereTheyLead) {
  Result result = good_result();
  result.notes.push_back({Severity::warning, "labels.gate_follows", "a border was missing", 2});
  EXPECT_EQ(verdict_of(assess(result)), Verdict::check);
  result.leading.ef_percent = heart::Estimate{60, 2};  // a fit, which needs no edges
  EXPECT_TRUE(is_flagged(result, "labels.gate_follows"));
  EXPECT_EQ(verdict_of(assess(result)), Verdict::ok);
}

TEST(Judge, DoubtsWhatIsBelievedOfTheWallOnlyWhereTheIntervalIsNarrow) {
  for (const std::string code : {"fit.thin_wall", "fit.thickness_believed"}) {
    Result result = good_result();
    result.notes.push_back({Severity::warning, code, "the wall is thin"});
    result.leading.edv_ml = heart::Estimate{100, 4};  // 90 % within 6.6 %
    EXPECT_EQ(verdict_of(assess(result)), Verdict::check) << code;
    result.leading.edv_ml->sd = 4.5;
    EXPECT_TRUE(is_flagged(result, code));
    EXPECT_EQ(verdict_of(assess(result)), Verdict::ok) << code;
    result.notes.push_back({Severity::warning, "another", "a doubt"});
    EXPECT_EQ(codes_of(result), (Codes{"another", code})) << "what decides comes first";
  }
}

TEST(Judge, DoesNotMissTheOuterBorderOfABloodPool) {
  Result result = good_result();
  for (Gate& gate : result.gates)
    gate.edge_surfaces.epi.reset(), gate.edge_surfaces.wall_ml.reset(), gate.labels.bright = ImageContrast::cavity;
  result.heart.reset(), result.wall_variation.reset();
  EXPECT_EQ(codes_of(result), Codes{"blood_pool"});
  result.gates[2].edge_surfaces.endo.reset();
  EXPECT_EQ(codes_of(result), (Codes{"surface_missing", "blood_pool"}));
}

TEST(Judge, FailsForABloodPoolThatIsNoCavity) {
  Result result = good_result();
  for (Gate& gate : result.gates)
    gate.edge_surfaces.epi.reset(), gate.edge_surfaces.wall_ml.reset(), gate.labels.bright = ImageContrast::cavity;
  result.heart.reset(), result.wall_variation.reset();
  result.leading.edv_ml = heart::Estimate{797};
  EXPECT_TRUE(is_flagged(result, "volume_implausible"));
  EXPECT_EQ(verdict_of(assess(result)), Verdict::fail) << "nothing but its brightness says that it is a heart";
}

}  // namespace
}  // namespace dynasurf::ventricle
