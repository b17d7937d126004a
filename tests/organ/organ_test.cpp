#include "dynasurf/organ/organ.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf::organ {
namespace {

synthetic::Organ small_liver() {
  synthetic::Organ o;
  o.lattice = {48, 40, 32, 6, 6, 7};
  return o;
}
synthetic::Organ prostate() {
  synthetic::Organ o;
  o.shape = synthetic::OrganShape::prostate;
  o.lattice = {56, 56, 26, 1.4, 1.4, 3};
  return o;
}

double mean_distance_mm(const TriMesh& mesh, const TriMesh& truth) {
  const mesh::ClosestPoint closest(truth);
  double sum = 0;
  for (const Vec3& p : mesh.vertices) sum += std::sqrt(closest(p).distance2);
  return sum / static_cast<double>(mesh.vertices.size());
}

void expect_near_truth(const synthetic::Phantom& phantom, const Options& options, double percent, double mm) {
  const Result result = reconstruct(phantom.study.gates.front(), options);
  ASSERT_TRUE(result.surface);
  EXPECT_TRUE(result.surface->repair.check.closed);
  EXPECT_EQ(result.surface->repair.check.self_intersections, 0);
  const synthetic::TrueGate& truth = phantom.truth.front();
  EXPECT_NEAR(100 * result.surface->volume_ml / truth.epi_ml, 100, percent);
  EXPECT_LT(mean_distance_mm(result.surface->mesh, truth.epi), mm);
}

TEST(Organ, PhantomsHaveTheVolumeThatIsAskedFor) {
  for (synthetic::Organ o : {small_liver(), prostate()}) {
    o.volume_ml = 200;
    EXPECT_NEAR(synthetic::make_phantom(synthetic::PhantomOptions{o}).truth.front().epi_ml, 200, 1e-9);
  }
}

// Measured: -0.4 and -0.6 %, on voxels of 6 x 6 x 7 and 1.4 x 1.4 x 3 mm; label maps -1.0 %, PET -0.7 %.
TEST(Organ, OfCtAndMrKeepsItsVolume) {
  for (const char* modality : {"ct", "mr"}) {
    expect_near_truth(synthetic::make_phantom(synthetic::PhantomOptions{small_liver()}), preset(modality), 2, 1.5);
    expect_near_truth(synthetic::make_phantom(synthetic::PhantomOptions{prostate()}), preset(modality), 2, 0.4);
  }
}

TEST(Organ, DarkerThanItsSurroundingsIsFoundToo) {
  synthetic::Organ o = prostate();
  o.inside = 0.4, o.outside = 1, o.neighbour = 0.4;
  Options options = preset("mr");
  options.dark = true;
  // What lies around reaches the edge, but the largest dark body is the organ.
  expect_near_truth(synthetic::make_phantom(synthetic::PhantomOptions{o}), options, 2, 0.4);
}

TEST(Organ, OfALabelMapIsTheOneThatIsNamed) {
  synthetic::Organ o = small_liver();
  o.values = synthetic::OrganValues::labels;
  Options options = preset("labels");
  options.label = 1;
  expect_near_truth(synthetic::make_phantom(synthetic::PhantomOptions{o}), options, 2, 1.5);
  options.label = 2;
  const Result ball = reconstruct(synthetic::make_phantom(synthetic::PhantomOptions{o}).study.gates.front(), options);
  ASSERT_TRUE(ball.surface);
  EXPECT_LT(ball.surface->volume_ml, 0.2 * synthetic::make_phantom(synthetic::PhantomOptions{o}).truth.front().epi_ml);
  options.label = 7;
  const Result none = reconstruct(synthetic::make_phantom(synthetic::PhantomOptions{o}).study.gates.front(), options);
  EXPECT_FALSE(none.surface);
  EXPECT_EQ(none.notes.back().code, "organ.none");
}

TEST(Organ, OfPetIsOutlinedThroughBlurAndNoise) {
  synthetic::Organ o = small_liver();
  o.fwhm_mm = 7, o.outside = 0.05, o.neighbour = 0.05;
  o.noise = {200, 5, 0, 3};
  // The outline at 42 % of the brightest voxel, settled on the steepest slope.
  expect_near_truth(synthetic::make_phantom(synthetic::PhantomOptions{o}), preset("pet"), 4, 2);
}

TEST(Organ, ThatReachesTheEdgeOfTheImageSaysSo) {
  synthetic::Organ o = small_liver();
  o.pose.offset_x_mm = 90;
  const Result result =
      reconstruct(synthetic::make_phantom(synthetic::PhantomOptions{o}).study.gates.front(), preset("ct"));
  ASSERT_FALSE(result.notes.empty());
  EXPECT_EQ(result.notes.front().code, "organ.cut_off");
}

TEST(Organ, IsTheLargestBodyWithoutItsHolesAndSaysWhatIsLeftOut) {
  Image image(Grid{{48, 36, 36}, Vec3::Constant(2.0)});
  const auto is_in_ball = [&](int i, int j, int k, const Vec3& centre, double radius_mm) {
    return (centre_of(image.grid, {i, j, k}) - centre).norm() < radius_mm;
  };
  std::size_t solid = 0;
  for (int k = 0; k < 36; ++k)
    for (int j = 0; j < 36; ++j)
      for (int i = 0; i < 48; ++i) {
        const bool large = is_in_ball(i, j, k, {30, 35, 35}, 20), hole = is_in_ball(i, j, k, {30, 35, 35}, 7);
        image(i, j, k) = (large && !hole) || is_in_ball(i, j, k, {74, 35, 35}, 12) ? 1.0F : 0.0F;
        solid += large;
      }
  const Result result = reconstruct(image, preset("labels"));
  ASSERT_TRUE(result.surface);
  EXPECT_NEAR(result.voxels_ml, 8e-3 * static_cast<double>(solid), 1e-9);
  EXPECT_NEAR(result.surface->volume_ml / result.voxels_ml, 1, 0.03);  // steps of voxels, smoothed
  ASSERT_FALSE(result.notes.empty());
  EXPECT_EQ(result.notes.front().code, "organ.parts");
}

TEST(Organ, RefusesWhatIsNoImageOrNoPreset) {
  EXPECT_THROW(preset("ultrasound"), OptionError);
  Grid grid;
  grid.dims = {2, 8, 8};
  EXPECT_THROW(reconstruct(Image(grid), {}), InputError);
  grid.dims = {8, 8, 8};
  Image image(grid);
  image.values[7] = std::nanf("");
  EXPECT_THROW(reconstruct(image, {}), InputError);
}

}  // namespace
}  // namespace dynasurf::organ
