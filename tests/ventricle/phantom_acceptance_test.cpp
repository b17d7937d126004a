// What the main job must reach on the thesis's phantom (tables 4.1, 6.8 and 6.10), measured against the data's own
// voxel volume as the thesis does, and against the analytic volume of the walls, which it does not.
#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/detail/voxel_truth.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/detail/surface.hpp"

namespace dynasurf::ventricle {
namespace {

Surface surface_on(const Image& border, int level, const dynamics::SolverOptions& solver = dynamics::Rk4{}) {
  const field::FlowResult flow = field::flow_field(border, field::Gvf{});
  dynamics::Evolution evolution;
  evolution.solver = solver;
  return measure_surface(
      dynamics::evolve(mesh::place(mesh::icosphere(level), border, mesh::Placement{}), flow.field, border, evolution),
      border);
}

Image hebron_image() {
  static const synthetic::Phantom phantom = synthetic::make_phantom(synthetic::Hebron{});
  return phantom.study.gates.front();
}

class HebronSurface : public testing::TestWithParam<int> {};

TEST_P(HebronSurface, OfTheEpicardiumHoldsTheVolumeOfTheDataWithinTwoPercent) {
  const Mask solid = synthetic::filled_solid(hebron_image());
  const double data_ml = synthetic::voxel_volume_ml(image::unite(solid, image::cover_disc(solid, 35)));
  const Surface s = surface_on(synthetic::external_border(hebron_image(), 0.2, 35), GetParam());
  RecordProperty("volume_ml", std::to_string(s.volume_ml));
  RecordProperty("data_ml", std::to_string(data_ml));
  EXPECT_NEAR(s.volume_ml, data_ml, 0.02 * data_ml);
  EXPECT_GE(s.within_one_voxel, 0.97);
  EXPECT_NE(s.stop_reason, dynamics::StopReason::diverged);
}

TEST_P(HebronSurface, OfTheEndocardiumHoldsTheVolumeOfTheCavityWithinFivePercent) {
  const double data_ml = synthetic::voxel_volume_ml(synthetic::enclosed_cavity(hebron_image()));
  const Surface s = surface_on(synthetic::internal_border(hebron_image()), GetParam());
  RecordProperty("volume_ml", std::to_string(s.volume_ml));
  RecordProperty("data_ml", std::to_string(data_ml));
  EXPECT_NEAR(s.volume_ml, data_ml, 0.05 * data_ml);
}

INSTANTIATE_TEST_SUITE_P(Levels, HebronSurface, testing::Values(3, 4),
                         [](const auto& level) { return level.param == 3 ? "642Vertices" : "2562Vertices"; });

TEST(HebronSurface, IsTheSameForEverySolverWithinTwoPercent) {  // table 6.8: 0.7 to 1.5 % apart
  const Image border = synthetic::external_border(hebron_image(), 0.2, 35);
  const double rk4 = surface_on(border, 2, dynamics::Rk4{}).volume_ml;
  EXPECT_NEAR(surface_on(border, 2, dynamics::Euler{}).volume_ml, rk4, 0.02 * rk4);
  EXPECT_NEAR(surface_on(border, 2, dynamics::Midpoint{}).volume_ml, rk4, 0.02 * rk4);
}

}  // namespace
}  // namespace dynasurf::ventricle
