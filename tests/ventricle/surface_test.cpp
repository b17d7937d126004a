#include "dynasurf/ventricle/detail/surface.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "dynasurf/mesh/intersections.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf::ventricle {
namespace {

/// A ball of 30 mm as if it had come to rest, and voxels around it.
dynamics::EvolutionResult ball_at_rest() {
  dynamics::EvolutionResult evolved;
  evolved.mesh = mesh::icosphere(3);
  for (Vec3& p : evolved.mesh.vertices) p = 30 * p + Vec3(40, 40, 40);
  evolved.reason = dynamics::StopReason::all_stopped;
  evolved.stopped_fraction = 1;
  return evolved;
}

Image voxels() {
  Grid grid;
  grid.dims = {21, 21, 21};
  grid.spacing = {4, 4, 4};
  return Image(grid, 1);
}

TEST(MeasureSurface, SaysThatAGoodSurfaceIsOne) {
  const Surface s = measure_surface(ball_at_rest(), voxels());
  EXPECT_TRUE(s.repair.check.valid());
  EXPECT_EQ(s.repair.tidied.vertices_moved, 0u);
  EXPECT_TRUE(s.notes.empty());
  EXPECT_EQ(s.within_one_voxel, 1);
}

TEST(MeasureSurface, FreesASurfaceThatCutsItselfAndTells) {
  dynamics::EvolutionResult evolved = ball_at_rest();
  evolved.mesh.vertices[0] -= Vec3(2.4 * (evolved.mesh.vertices[0] - Vec3(40, 40, 40)));
  const Surface s = measure_surface(evolved, voxels(), std::nullopt, {.shape = 0});
  EXPECT_TRUE(s.repair.check.valid());
  ASSERT_EQ(s.notes.size(), 1u);
  EXPECT_EQ(s.notes[0].code, "surface.untangled");
  EXPECT_EQ(s.notes[0].severity, Severity::info);

  const Surface tangled = measure_surface(evolved, voxels(), std::nullopt, {.shape = 0, .untangle_rounds = 0});
  EXPECT_GT(tangled.repair.check.self_intersections, 0u);
  ASSERT_EQ(tangled.notes.size(), 1u);
  EXPECT_EQ(tangled.notes[0].code, "surface.tangled");
  EXPECT_EQ(tangled.notes[0].severity, Severity::warning);
}

TEST(MeasureSurface, CutAtAPlaneIsStillFitToPublish) {
  const heart::BasePlane plane{{40, 40, 52}, Vec3(0.1, -0.2, 1).normalized()};
  const Surface s = measure_surface(ball_at_rest(), voxels(), plane);
  EXPECT_TRUE(s.repair.check.valid());
  EXPECT_GT(s.quality.shape_min, 0.1);
  for (const Vec3& p : s.mesh.vertices) EXPECT_LT(plane.height(p), 1e-9);
}

class VirtualPatients : public testing::TestWithParam<std::uint64_t> {};

TEST_P(VirtualPatients, HaveValidSurfacesWithSoundTrianglesOfTheSameVolume) {
  synthetic::VirtualPatient patient;
  patient.gates = 3;
  patient.noise.seed = GetParam();
  const Study study = synthetic::make_phantom(patient).study;
  Options raw = preset("edges");
  raw.tidy = {.shape = 0, .untangle_rounds = 0};
  const Result with = reconstruct(study, preset("edges")), without = reconstruct(study, raw);
  double worst_before = 1, worst_after = 1;
  for (std::size_t g = 0; g < with.gates.size(); ++g)
    for (const auto wall : {Border::endo, Border::epi}) {
      const auto& after = with.gates[g].edge_surfaces.of(wall);
      const auto& before = without.gates[g].edge_surfaces.of(wall);
      ASSERT_TRUE(after && before);
      EXPECT_TRUE(after->repair.check.valid()) << g;
      EXPECT_NEAR(after->volume_ml, before->volume_ml, 0.002 * before->volume_ml);
      EXPECT_NEAR(after->mean_distance_mm, before->mean_distance_mm, 0.05);
      worst_after = std::min(worst_after, after->quality.shape_min);
      worst_before = std::min(worst_before, before->quality.shape_min);
    }
  EXPECT_GT(worst_after, 0.25);
  EXPECT_GT(worst_after, worst_before + 0.1);
}

INSTANTIATE_TEST_SUITE_P(Seeds, VirtualPatients, testing::Values(1, 2));

TEST(VirtualPatientsAtRandom, HaveSurfacesThatAreValidOrSaidNotToBe) {
  // Small and large, with defects, gut and noise. The mesh is looked at again, not only its certificate.
  int surfaces = 0;
  for (const std::uint64_t seed : {11, 12, 13, 14, 15, 16}) {
    synthetic::VirtualPatient patient;
    patient.gates = 2;
    patient.edv_ml = 45 + 35.0 * static_cast<double>(seed - 11);
    patient.ef_percent = seed % 2 == 0 ? 70 : 35;
    patient.defect = seed % 3 == 0   ? synthetic::Defect::apical
                     : seed % 3 == 1 ? synthetic::Defect::none
                                     : synthetic::Defect::lateral;
    patient.gut_amplitude = seed % 2 == 0 ? 0.8 : 0;
    patient.noise = {60, 8, 0, seed};
    const Result result = reconstruct(synthetic::make_phantom(patient).study, preset("edges"));
    const bool is_told = std::any_of(result.flags.begin(), result.flags.end(),
                                     [](const QualityFlag& f) { return f.code == "surface_invalid"; });
    for (const Gate& gate : result.gates)
      for (const auto* wall : {&gate.edge_surfaces.endo, &gate.edge_surfaces.epi}) {
        if (!*wall) continue;
        ++surfaces;
        const TriMesh& mesh = (*wall)->mesh;
        const mesh::Topology t = mesh::topology(mesh);
        const bool is_valid =
            t.closed() && t.oriented() && t.components == 1 && t.euler == 2 && mesh::self_intersections(mesh).free();
        EXPECT_EQ(is_valid, (*wall)->repair.check.valid()) << "seed " << seed;
        EXPECT_TRUE(is_valid || is_told) << "seed " << seed;
        EXPECT_GT(mesh::volume_mm3(mesh), 0);  // right side out
      }
  }
  EXPECT_GE(surfaces, 20);  // of 24
}

TEST(Motion, HoldsTheFieldThatPulledItsParticlesAndTheBorderTheyStoppedAt) {
  Options options = preset("edges");
  options.evolution.trajectory_every = 20;
  options.evolution.damping = dynamics::BorderDrag{};
  const Result result = reconstruct(synthetic::make_phantom(synthetic::Hebron{}).study, options);
  for (const Border wall : {Border::endo, Border::epi}) {
    const auto& motion = result.gates[0].edge_surfaces.of(wall)->motion;
    ASSERT_TRUE(motion && motion->drag);
    const Grid& grid = motion->border.grid;
    int pulled = 0;
    double off = 0, strength = 0;
    for (const dynamics::TrajectoryStep& step : motion->steps)
      for (std::size_t v = 0; v < step.places.size(); ++v) {
        if (step.stopped[v] != 0) continue;
        const Vec3 there =
            field::sample(motion->field, to_grid(grid, step.places[v]), options.evolution.force.sampling);
        const Vec3 pull = options.evolution.force.strength * (grid.direction * there);
        ++pulled, off += (pull - step.pulls[v]).norm(), strength += pull.norm();
      }
    EXPECT_GT(pulled, 600);
    EXPECT_LT(off, 1e-3 * strength);  // places at the border of two voxels may fall into either
    // Where a particle has stopped the drag is no smaller than anywhere.
    float most = 0, at_border = 0;
    for (std::size_t n = 0; n < motion->border.values.size(); ++n) {
      most = std::max(most, motion->drag->values[n]);
      if (motion->border.values[n] > 0) at_border = std::max(at_border, motion->drag->values[n]);
    }
    EXPECT_EQ(at_border, most);
  }
}

}  // namespace
}  // namespace dynasurf::ventricle
