// The first version of the system (PIPE-1, thesis 7.1) and the starts other than an ellipsoid around the data.
#include <algorithm>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/presets.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf::ventricle {
namespace {

const synthetic::Phantom& patient() {
  static const synthetic::Phantom phantom = [] {
    synthetic::VirtualPatient options;
    options.gates = 1;
    return synthetic::make_phantom(options);
  }();
  return phantom;
}

void expect_both_walls(const Result& result) {
  ASSERT_TRUE(result.gates[0].edge_surfaces.endo && result.gates[0].edge_surfaces.epi);
  for (const Surface* s : {&*result.gates[0].edge_surfaces.endo, &*result.gates[0].edge_surfaces.epi}) {
    EXPECT_TRUE(s->repair.check.valid());
    EXPECT_GT(s->volume_ml, 0);
    EXPECT_GT(s->within_one_voxel, 0.9);
  }
}

TEST(Direct, FindsTheOuterWallAsTheStandardPipelineDoesAndTheInnerOneFromInside) {
  Options options = preset("edges");
  options.pipeline = Pipeline::direct;
  const Result direct = reconstruct(patient().study, options), standard = reconstruct(patient().study, preset("edges"));
  expect_both_walls(direct);
  EXPECT_NEAR(direct.gates[0].edge_surfaces.epi->volume_ml, standard.gates[0].edge_surfaces.epi->volume_ml,
              0.02 * standard.gates[0].edge_surfaces.epi->volume_ml);
  EXPECT_NE(direct.gates[0].edge_surfaces.epi->volume_ml, standard.gates[0].edge_surfaces.epi->volume_ml);
  // An image has no lid over the base, so nothing pulls a growing surface up there: the result says so.
  const auto is_unreached = [](const QualityFlag& f) { return f.code == "border_unreached"; };
  EXPECT_LT(direct.gates[0].edge_surfaces.endo->border_reached, 0.8);
  EXPECT_GT(direct.gates[0].edge_surfaces.epi->border_reached, 0.95);
  EXPECT_EQ(std::count_if(direct.flags.begin(), direct.flags.end(), is_unreached), 1);
  EXPECT_NE(direct.verdict, Verdict::ok);
  EXPECT_EQ(std::count_if(standard.flags.begin(), standard.flags.end(), is_unreached), 0);
  EXPECT_LT(direct.gates[0].edge_surfaces.endo->volume_ml, 0.8 * standard.gates[0].edge_surfaces.endo->volume_ml);
  EXPECT_GT(direct.gates[0].edge_surfaces.endo->volume_ml, 0.5 * standard.gates[0].edge_surfaces.endo->volume_ml);

  options.placement.shape = mesh::StartShape::marching_cubes;
  const Result cubes = reconstruct(patient().study, options);
  expect_both_walls(cubes);
  EXPECT_NEAR(cubes.gates[0].edge_surfaces.endo->volume_ml, standard.gates[0].edge_surfaces.endo->volume_ml,
              0.05 * standard.gates[0].edge_surfaces.endo->volume_ml);
  EXPECT_EQ(std::count_if(cubes.flags.begin(), cubes.flags.end(), is_unreached), 0);
}

TEST(Starts, OfEveryShapeEndOnTheSameBorders) {
  const TriMesh given = mesh::cube_surface(6);
  Options options = preset("edges");
  options.field = field::SteadyGvf{};  // reaches as far as the sphere around a long heart
  const Result standard = reconstruct(patient().study, options);
  for (const mesh::StartShape shape : {mesh::StartShape::sphere, mesh::StartShape::cube, mesh::StartShape::hull,
                                       mesh::StartShape::marching_cubes, mesh::StartShape::file}) {
    options.placement.shape = shape;
    SCOPED_TRACE(word_of(shape));
    const Result result = reconstruct(patient().study, options, {}, {}, &given);
    expect_both_walls(result);
    EXPECT_NE(result.gates[0].edge_surfaces.epi->mesh.vertices, standard.gates[0].edge_surfaces.epi->mesh.vertices)
        << "the shape was not heard";
    // The given cube has 218 vertices, and a coarse mesh reads low by its chords.
    const double tolerance = shape == mesh::StartShape::file ? 0.12 : 0.05;
    for (const auto wall : {Border::endo, Border::epi}) {
      const double volume = standard.gates[0].edge_surfaces.of(wall)->volume_ml;
      EXPECT_NEAR(result.gates[0].edge_surfaces.of(wall)->volume_ml, volume, tolerance * volume);
    }
  }
}

TEST(Starts, FromAFileNeedAMesh) {
  Options file = preset("edges");
  file.placement.shape = mesh::StartShape::file;
  EXPECT_THROW(reconstruct(patient().study, file), OptionError);
}

TEST(Starts, FromInsideReadLow) {
  // Table 5.5: the top is poorly resolved when a surface grows from inside.
  Options options = preset("edges");
  options.placement.direction = mesh::Direction::in_to_out;
  const Result inside = reconstruct(patient().study, options), outside = reconstruct(patient().study, preset("edges"));
  expect_both_walls(inside);
  for (const auto wall : {Border::endo, Border::epi}) {
    EXPECT_LT(inside.gates[0].edge_surfaces.of(wall)->volume_ml, outside.gates[0].edge_surfaces.of(wall)->volume_ml);
    EXPECT_GT(inside.gates[0].edge_surfaces.of(wall)->volume_ml,
              0.8 * outside.gates[0].edge_surfaces.of(wall)->volume_ml);
  }
}

TEST(Starts, SayWhenGatesHaveTrianglesOfTheirOwn) {
  synthetic::VirtualPatient two;
  two.gates = 2;
  Options options = preset("edges");
  options.placement.shape = mesh::StartShape::marching_cubes;
  const Result result = reconstruct(synthetic::make_phantom(two).study, options);
  const auto said = std::count_if(result.notes.begin(), result.notes.end(),
                                  [](const Note& n) { return n.code == "surface.no_correspondence"; });
  EXPECT_EQ(said, 1);
}

}  // namespace
}  // namespace dynasurf::ventricle
