#include <algorithm>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/detail/cycle.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "support/blurred_heart.hpp"

namespace dynasurf::ventricle {
namespace {

Study study_of(const Image& image) {
  Study study;
  study.gates = {image};
  return study;
}

TEST(FindBorders, FindsWhatReconstructFinds) {
  test::HeartShape h;
  h.noise = 0.03;
  const Study study = study_of(test::blurred_heart(h));
  const BorderResult borders = find_borders(study, {});
  const Result whole = reconstruct(study, preset("edges"));
  ASSERT_EQ(borders.gates.size(), 1U);
  EXPECT_TRUE(borders.gates[0].labels.has(Border::endo));
  EXPECT_EQ(borders.gates[0].labels.borders.values, whole.gates[0].labels.borders.values);
  EXPECT_EQ(borders.gates[0].base_slice, whole.gates[0].base_slice);
  EXPECT_EQ(borders.study.gates[0].values, whole.study.gates[0].values);
}

TEST(FindBorders, TakesTheEndOfATubeFromTheOrderOfItsSlices) {
  // A third of the wall is missing from the apex: the base could be at either end.
  synthetic::Partial tube;
  tube.missing = synthetic::Missing::apex;
  const Study study = synthetic::make_phantom(synthetic::PhantomOptions{tube}).study;
  ASSERT_EQ(study.slice_order, SliceOrder::apex_to_base);
  const BorderResult borders = find_borders(study, {});
  ASSERT_TRUE(borders.heart);
  EXPECT_GT(borders.heart->cup.axis.dot(study.grid().direction.col(2)), 0.9);
  EXPECT_TRUE(borders.gates[0].labels.has(Border::endo));
  EXPECT_TRUE(borders.gates[0].labels.has(Border::epi));
}

TEST(FindBorders, PreparesTheValuesWhenAsked) {
  const Study study = study_of(test::blurred_heart({}));
  Options o = preset("edges");
  o.prepare.doubling = image::Preparation::Doubling::three;
  const BorderResult borders = find_borders(study, o);
  EXPECT_EQ(borders.study.grid().dims, (Index3{128, 128, 46}));
  EXPECT_TRUE(borders.gates[0].labels.has(Border::epi));
}

TEST(BloodPoolStudy, HasACavityAndAnEjectionFractionButNoWall) {
  synthetic::VirtualPatient o;
  o.cavity = 8, o.background = 0.5;  // the wall is 1
  const synthetic::Phantom phantom = synthetic::make_phantom(o);
  const Result result = reconstruct(phantom.study, {});
  EXPECT_EQ(result.verdict, Verdict::check);
  ASSERT_EQ(std::count_if(result.flags.begin(), result.flags.end(),
                          [](const QualityFlag& f) { return f.code == "blood_pool"; }),
            1);
  for (const Gate& gate : result.gates) {
    EXPECT_TRUE(gate.edge_surfaces.endo);
    EXPECT_FALSE(gate.edge_surfaces.epi);
  }
  EXPECT_FALSE(result.readings.psf_corrected) << "there is no wall to fit, and a note says so";
  EXPECT_EQ(
      std::count_if(result.notes.begin(), result.notes.end(), [](const Note& n) { return n.code == "fit.no_walls"; }),
      1);
  ASSERT_TRUE(result.readings.edge.ef_percent && result.readings.edge.edv_ml);
  EXPECT_NEAR(result.readings.edge.ef_percent->value, *phantom.ef_percent, 8);
  EXPECT_NEAR(result.readings.edge.edv_ml->value / *phantom.edv_ml, 1, 0.25)
      << "the edge lies near the rim, and the base is open";
}

bool has_flag(const Result& result, const std::string& code, Severity severity) {
  return std::any_of(result.flags.begin(), result.flags.end(),
                     [&](const QualityFlag& f) { return f.code == code && f.severity == severity; });
}

TEST(Fit, GoesWithoutAnEdgeSurfaceWhereTheHeartIsPlain) {
  synthetic::VirtualPatient o;
  o.gates = 4, o.lattice = {40, 40, 24, 5, 5, 5};
  synthetic::Phantom phantom = synthetic::make_phantom(o);
  // In two gates the cavity is as bright as the wall.
  const Grid& grid = phantom.study.grid();
  const auto heart = heart::locate(heart::mean_image(phantom.study.gates));
  ASSERT_TRUE(heart);
  for (const int g : {1, 2}) {
    std::vector<float>& values = phantom.study.gates[g].values;
    const float wall = *std::max_element(values.begin(), values.end());
    for (int k = 0; k < grid.dims[2]; ++k)
      for (int j = 0; j < grid.dims[1]; ++j)
        for (int i = 0; i < grid.dims[0]; ++i)
          if (heart::signed_distance(heart->cup, to_world(grid, centre_of(grid, {i, j, k}))) < 0)
            values[grid.index(i, j, k)] = wall;
  }
  const Result result = reconstruct(phantom.study, {});
  EXPECT_FALSE(result.gates[1].edge_surfaces.endo && result.gates[1].edge_surfaces.epi);
  EXPECT_TRUE(has_flag(result, "surface_missing", Severity::warning));
  EXPECT_EQ(result.verdict, Verdict::check);
  ASSERT_TRUE(result.readings.psf_corrected);
  EXPECT_FALSE(result.readings.edge.edv_ml) << "edges alone read nothing";
  EXPECT_TRUE(result.leading.edv_ml && result.leading.edv_ml->has_interval());
}

TEST(ExpectedCavityEnd, LiesUnderTheApexOfAHeartThatWasClearlySeen) {
  Study study = study_of(test::blurred_heart({}));  // slices of 5.74 mm
  heart::Location heart;
  heart.cup = {{90, 90, 70}, {0, 0, 1}, 30, 45, 25};
  heart.contrast = 0.6, heart.ridge_share = 0.9;
  EXPECT_NEAR(*expected_cavity_end(study, heart), (70 - 45 + 3) / 5.74, 1e-9);
  heart.contrast = 0.1;
  EXPECT_FALSE(expected_cavity_end(study, heart));
  heart.contrast = 0.6, heart.cup.axis = {0, 0, -1};
  EXPECT_FALSE(expected_cavity_end(study, heart)) << "it stands on its head";
  EXPECT_FALSE(expected_cavity_end(study, std::nullopt));
}

TEST(ManualPlaces, MustBeOfTheStudy) {
  const Study study = study_of(test::blurred_heart({}));  // 64 x 64 x 23 voxels of 2.87 x 2.87 x 5.74 mm, from 0
  const auto refuses = [&](const auto& set, const char* says) {
    Options o = preset("edges");
    set(o.manual);
    try {
      find_borders(study, o);
      ADD_FAILURE() << says;
    } catch (const OptionError& e) {
      EXPECT_NE(std::string(e.what()).find(says), std::string::npos) << e.what();
    }
  };
  refuses([](UserOverrides& m) { m.center_mm = {90, 90, 500}; }, "inside the volume");
  refuses([](UserOverrides& m) { m.first_slice = 24; },
          "first_slice is 24; expected a slice of the short-axis stack, 1 to 23");
  refuses([](UserOverrides& m) { m.last_slice = 24; }, "manual.last_slice is 24");
  refuses([](UserOverrides& m) { m.first_slice = 12, m.last_slice = 11; }, "not to lie after the last");
  refuses([](UserOverrides& m) { m.base_plane_mm = 127; }, "0 to 126.28 mm");
  refuses([](UserOverrides& m) { m.base_plane_mm = -1; }, "manual.base_plane_mm is -1");
  refuses([](UserOverrides& m) { m.endo_points = {1, 0, 0}; }, "endo_points holds 3 numbers; expected four");
  refuses([](UserOverrides& m) { m.epi_points = {2, 90, 90, 60}; }, "epi_points names gate 2; expected gates 1 to 1");
  refuses([](UserOverrides& m) { m.epi_points = {0.5, 90, 90, 60}; }, "epi_points names gate 0.5");
  refuses([](UserOverrides& m) { m.endo_points = {1, 90, 90, 900}; }, "expected one inside the volume");
}

TEST(ManualPlaces, AtTheEdgesOfTheStudyAreFollowed) {
  const Study study = study_of(test::blurred_heart({}));
  Options o = preset("edges");
  o.manual.first_slice = 8, o.manual.last_slice = 23;
  const BorderResult result = find_borders(study, o);
  const Mask& edges = result.gates[0].edges.edges;
  const auto first_kept = edges.values.begin() + static_cast<std::ptrdiff_t>(edges.grid.index(0, 0, 7));
  EXPECT_TRUE(std::all_of(edges.values.begin(), first_kept, [](auto v) { return v == 0; }));
  EXPECT_TRUE(result.gates[0].labels.has(Border::endo));
}

TEST(OnlyGate, IsFoundAsInTheWholeStudyWithItsFields) {
  Study study = study_of(test::blurred_heart({}));
  study.gates.resize(4, study.gates.front());
  const Options options = preset("edges");
  const BorderResult whole = find_borders(study, options);
  const BorderResult alone = find_borders(study, options, {}, {.only_gate = 2});
  ASSERT_EQ(alone.gates.size(), whole.gates.size());
  EXPECT_EQ(alone.gates[2].edges.edges.values, whole.gates[2].edges.edges.values);
  EXPECT_EQ(alone.study.grid(), whole.study.grid());
  EXPECT_TRUE(alone.gates[1].edges.edges.values.empty());
  for (const auto& wall : {alone.gates[2].endo, alone.gates[2].epi}) {
    ASSERT_TRUE(wall);
    EXPECT_EQ(wall->field.x.size(), wall->border.grid.size());
    EXPECT_GT(std::count_if(wall->border.values.begin(), wall->border.values.end(), [](float v) { return v > 0; }),
              100);
  }
  EXPECT_FALSE(whole.gates[2].endo);
}

TEST(ExcludedGates, AreThoseOfTheBeatNobodyLooksAt) {
  Study study = study_of(test::blurred_heart({}));
  study.gates.resize(4, study.gates.front());
  Study spoilt = study;
  std::fill(spoilt.gates[2].values.begin(), spoilt.gates[2].values.end(), 7.f);
  for (std::size_t v = 0; v < spoilt.gates[2].values.size(); v += 5) spoilt.gates[2].values[v] = 900;
  Options o = preset("edges");
  const BorderResult whole = find_borders(study, o);
  o.manual.exclude_gates = {3};
  const BorderResult found = find_borders(spoilt, o);
  for (std::size_t g = 0; g < 4; ++g)
    EXPECT_EQ(found.gates[g].labels.borders.values, whole.gates[g].labels.borders.values) << g;
  const auto says = [](const Note& note) { return note.code == "gate.excluded" && note.gate == 2; };
  EXPECT_EQ(std::count_if(found.study.notes.begin(), found.study.notes.end(), says), 1);
}

TEST(ExcludedGates, AreGatesAndNotMostOfThem) {
  Study study = study_of(test::blurred_heart({}));
  study.gates.resize(3, study.gates.front());
  const auto refuses = [&](std::vector<int> gates, const char* says) {
    Options o = preset("edges");
    o.manual.exclude_gates = std::move(gates);
    try {
      find_borders(study, o);
      ADD_FAILURE() << says;
    } catch (const OptionError& e) {
      EXPECT_NE(std::string(e.what()).find(says), std::string::npos) << e.what();
    }
  };
  refuses({4}, "names gate 4; expected gates 1 to 3");
  refuses({0}, "names gate 0");
  refuses({1, 2}, "more than half of the 3 gates");
}

TEST(ManualAxis, IsWhatSlicesAreCutSquareTo) {
  const Study study = study_of(test::blurred_heart({}));
  const Vec3 axis = study.grid().direction * Vec3(0.1, 0, 1).normalized();  // 6 degrees off: the stack would be kept
  Options o = preset("edges");
  o.manual.axis = {axis[0], axis[1], axis[2]};
  const BorderResult result = find_borders(study, o);
  EXPECT_LT((result.study.grid().direction.col(2) - axis).norm(), 1e-9);
  EXPECT_TRUE(result.gates[0].labels.has(Border::endo));
}

}  // namespace
}  // namespace dynasurf::ventricle
