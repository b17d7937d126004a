#include "dynasurf/heart/locate.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf::heart {
namespace {

constexpr double degree = std::numbers::pi / 180;

/// An ungated heart in a cubic field of view, leaning by `tilt_deg`.
synthetic::VirtualPatient tilted_patient(double tilt_deg, double towards_deg = 30) {
  synthetic::VirtualPatient p;
  p.gates = 1;
  p.lattice = {52, 52, 46, 4.5, 4.5, 4.5};
  p.pose.tilt_deg = tilt_deg;
  p.pose.tilt_towards_deg = towards_deg;
  return p;
}

Vec3 true_axis(const synthetic::Phantom& phantom, const synthetic::Pose& pose) {
  const double t = pose.tilt_deg * degree, a = pose.tilt_towards_deg * degree;
  return phantom.study.grid().direction * Vec3(std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t));
}

/// Mean of the vertices of the inner surface: on the axis, within the heart.
Vec3 middle_of_cavity(const synthetic::Phantom& phantom) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : phantom.truth.front().endo.vertices)
    sum += p / static_cast<double>(phantom.truth.front().endo.vertices.size());
  return sum;
}

double distance_to_axis(const Vec3& p, const LvShell& cup) {
  const Vec3 d = p - cup.centre;
  return (d - d.dot(cup.axis) * cup.axis).norm();
}

double angle_deg(const Vec3& a, const Vec3& b) { return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) / degree; }

class Locate : public testing::TestWithParam<double> {};

TEST_P(Locate, FindsAxisAndPlaceOfAHeartThatLiesAnyWay) {
  const synthetic::VirtualPatient patient = tilted_patient(GetParam());
  const synthetic::Phantom phantom = synthetic::make_phantom(patient);
  const auto found = locate(mean_image(phantom.study.gates));
  ASSERT_TRUE(found);
  // Noise and the coarse voxels leave one or two degrees.
  EXPECT_LT(angle_deg(found->cup.axis, true_axis(phantom, patient.pose)), 4);
  EXPECT_LT(distance_to_axis(middle_of_cavity(phantom), found->cup), 2);
  EXPECT_GT(found->contrast, 0.5);
  EXPECT_LT(found->other_end, 0.95);
}
INSTANTIATE_TEST_SUITE_P(Tilts, Locate, testing::Values(0.0, 40.0, 90.0, 135.0, 180.0));

TEST(LocateCup, TurnsWithTheVolume) {
  const synthetic::Phantom phantom = synthetic::make_phantom(tilted_patient(35));
  const Image image = mean_image(phantom.study.gates);
  // The same voxels with columns and slices exchanged, each still in its place in the world.
  Grid grid = image.grid;
  std::swap(grid.dims[0], grid.dims[2]);
  std::swap(grid.spacing[0], grid.spacing[2]);
  grid.direction.col(0).swap(grid.direction.col(2));
  Image turned(grid);
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) turned(i, j, k) = image(k, j, i);
  const auto one = locate(image), other = locate(turned);
  ASSERT_TRUE(one && other);
  // The search is the same up to the order of its steps; the fit at its end forgets where it came from.
  EXPECT_LT(angle_deg(one->cup.axis, other->cup.axis), 1.5);
  EXPECT_LT((one->cup.middle() - other->cup.middle()).norm(), 2);
}

TEST(LocateCup, IsNotMisledByHotGutOrAScale) {
  synthetic::VirtualPatient patient = tilted_patient(60);
  patient.gut_amplitude = 1.3;
  patient.right_ventricle = 0.4;
  const synthetic::Phantom phantom = synthetic::make_phantom(patient);
  Image image = mean_image(phantom.study.gates);
  const auto found = locate(image);
  ASSERT_TRUE(found);
  EXPECT_LT(angle_deg(found->cup.axis, true_axis(phantom, patient.pose)), 6);
  EXPECT_LT(distance_to_axis(middle_of_cavity(phantom), found->cup), 3);
  for (float& v : image.values) v *= 64;
  const auto scaled = locate(image);
  ASSERT_TRUE(scaled);
  EXPECT_LT((scaled->cup.middle() - found->cup.middle()).norm(), 1e-3);
}

/// A small heart that has lost its apex and the wall in front: what is left is a gutter, and a cup that leans into it
/// is brighter than the one that spans the gap.
TEST(LocateCup, SpansTheGapOfALargeDefect) {
  synthetic::VirtualPatient patient;
  patient.edv_ml = 48.2, patient.ef_percent = 44.17, patient.wall_ml = 81.2, patient.length_to_width = 1.61;
  patient.base_excursion_mm = 8.27, patient.gates = 8, patient.fwhm_mm = 9.75;
  patient.cavity = 0.095, patient.background = 0.0765;
  patient.defect = synthetic::Defect::anteroapical, patient.defect_extent_deg = 80.8, patient.defect_severity = 0.885;
  patient.lattice = {45, 45, 32, 4.8, 4.8, 4.8};
  patient.pose.offset_x_mm = -7.87, patient.pose.offset_y_mm = 10.75, patient.pose.offset_z_mm = 4.33;
  patient.pose.tilt_deg = 2.17, patient.pose.tilt_towards_deg = 124;
  patient.noise.peak_counts = 204, patient.noise.filter_fwhm_mm = 7.8, patient.noise.seed = 1208;
  const synthetic::Phantom phantom = synthetic::make_phantom(patient);
  const auto found = locate(mean_image(phantom.study.gates));
  ASSERT_TRUE(found);
  // The axis of a heart half of which is not seen; the leaning cup is 137 degrees off.
  EXPECT_LT(angle_deg(found->cup.axis, true_axis(phantom, patient.pose)), 5);
  EXPECT_LT(distance_to_axis(middle_of_cavity(phantom), found->cup), 3);
}

TEST(LocateCup, KeepsTheAxisAndStaysByThePlaceThatAPersonSays) {
  const synthetic::VirtualPatient patient = tilted_patient(60);
  const synthetic::Phantom phantom = synthetic::make_phantom(patient);
  LocateHints hints;
  hints.centre_mm = middle_of_cavity(phantom) + Vec3(3, -2, 1);
  hints.axis = -3 * true_axis(phantom, patient.pose);  // even if it is wrong: apex and base exchanged
  const auto found = locate(mean_image(phantom.study.gates), hints);
  ASSERT_TRUE(found);
  EXPECT_LT(angle_deg(found->cup.axis, *hints.axis), 1e-5);
  EXPECT_LT((found->cup.middle() - *hints.centre_mm).norm(), 25);
}

/// Something flat beside the heart, much brighter than its wall.
Image with_hot_slab(Image mean, const Vec3& middle, double times) {
  const Index3 v = voxel_of(mean.grid, to_grid(mean.grid, middle));
  const float wall = *std::max_element(mean.values.begin(), mean.values.end());
  for (int k = v[2] - 8; k < v[2] + 8; ++k)
    for (int j = v[1] + 13; j < v[1] + 17; ++j)
      for (int i = v[0] - 10; i < v[0] + 10; ++i) mean(i, j, k) = times * wall;
  return mean;
}

class HotSlab : public testing::TestWithParam<double> {};

TEST_P(HotSlab, DrawsNoSearchToItself) {
  const synthetic::VirtualPatient patient = tilted_patient(20);
  const synthetic::Phantom phantom = synthetic::make_phantom(patient);
  const Vec3 middle = middle_of_cavity(phantom);
  const auto found = locate(with_hot_slab(mean_image(phantom.study.gates), middle, GetParam()));
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->is_clear());
  EXPECT_LT(angle_deg(found->cup.axis, true_axis(phantom, patient.pose)), 8);
  EXPECT_LT(distance_to_axis(middle, found->cup), 4);
}
INSTANTIATE_TEST_SUITE_P(Times, HotSlab, testing::Values(3.0, 15.0, 60.0));

/// Of whose wall a defect left a ring in a bright body.
synthetic::VirtualPatient patient_without_apex() {
  synthetic::VirtualPatient patient = tilted_patient(70);
  patient.edv_ml = 160, patient.background = 0.3;
  patient.defect = synthetic::Defect::apical, patient.defect_extent_deg = 110, patient.defect_severity = 1;
  return patient;
}

TEST(LocateCup, FindsTheRingAtWhichAPersonPoints) {
  const synthetic::VirtualPatient patient = patient_without_apex();
  const synthetic::Phantom phantom = synthetic::make_phantom(patient);
  LocateHints hints;
  hints.centre_mm = middle_of_cavity(phantom) + Vec3(6, -5, 4);
  const Image mean = mean_image(phantom.study.gates);
  const auto alone = locate(mean);
  EXPECT_FALSE(alone && alone->is_clear()) << "too little of the wall is seen";
  const auto found = locate(mean, hints);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->is_pointed_at && found->is_believed() && !found->is_clear());
  EXPECT_LT(angle_deg(found->cup.axis, true_axis(phantom, patient.pose)), 15);
  EXPECT_LT((found->cup.middle() - *hints.centre_mm).norm(), 25);
}

TEST(LocateCup, BelievesNoOneWhoPointsAtABall) {
  Grid grid;
  grid.dims = {40, 40, 40};
  grid.spacing = {5, 5, 5};
  Image ball(grid);
  const Vec3 middle(100, 100, 100);
  for (int k = 0; k < 40; ++k)
    for (int j = 0; j < 40; ++j)
      for (int i = 0; i < 40; ++i) ball(i, j, k) = std::exp(-(centre_of(grid, {i, j, k}) - middle).squaredNorm() / 800);
  LocateHints hints;
  hints.centre_mm = to_world(grid, middle);
  const auto found = locate(ball, hints);
  EXPECT_FALSE(found && found->is_believed());
}

TEST(LvShell, HasTheVolumeOfItsPartBelowTheBase) {
  const LvShell half{{0, 0, 0}, {0, 0, 1}, 30, 45, 0};
  EXPECT_NEAR(volume_mm3(half), 2.0 / 3 * std::numbers::pi * 30 * 30 * 45, 1e-6);
  LvShell whole = half;
  whole.base_mm = 45;
  EXPECT_NEAR(volume_mm3(whole), 2 * volume_mm3(half), 1e-6);
}

TEST(LocateCup, FindsNothingInAnEmptyVolume) {
  Grid grid;
  grid.dims = {20, 20, 20};
  grid.spacing = {5, 5, 5};
  EXPECT_FALSE(locate(Image(grid)));
  EXPECT_FALSE(locate(Image(grid, 1.0F))) << "uniform: nothing is brighter than its surroundings";
  LocateHints hints;
  for (const Vec3& centre : {Vec3(50, 50, 50), Vec3(900, 0, 0)}) {
    hints.centre_mm = centre;
    EXPECT_FALSE(locate(Image(grid), hints));
    EXPECT_FALSE(locate(Image(grid, 1.0F), hints));
  }
}

TEST(LocateCup, FindsBothEndsOfALongWideHeart) {
  synthetic::VirtualPatient patient = tilted_patient(3);
  patient.edv_ml = 300, patient.wall_ml = 170, patient.length_to_width = 1.75;
  const synthetic::Phantom phantom = synthetic::make_phantom(patient);
  const auto found = locate(mean_image(phantom.study.gates));
  ASSERT_TRUE(found);
  // True surfaces begin with the apex and end with the middle of the base.
  const synthetic::TrueGate& truth = phantom.truth.front();
  const Vec3 apex = (truth.endo.vertices.front() + truth.epi.vertices.front()) / 2, base = truth.epi.vertices.back();
  EXPECT_LT((found->cup.middle() - (apex + base) / 2).norm(), 3);
  EXPECT_LT((found->cup.base() - base).norm(), 5);
  EXPECT_EQ(found->outside, 0);
}

TEST(LocateCup, FindsAHeartBesideAGutManyTimesAsHot) {
  for (const double position : {0.0, 0.3}) {
    synthetic::VirtualPatient patient;
    patient.gates = 1;
    patient.lattice = {40, 40, 24, 5, 5, 5};
    patient.gut_amplitude = 5, patient.gut_gap_mm = 5, patient.gut_radius_mm = 16, patient.gut_position = position;
    patient.noise.peak_counts = 300;
    const synthetic::Phantom phantom = synthetic::make_phantom(patient);
    const auto found = locate(mean_image(phantom.study.gates));
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->is_clear());
    EXPECT_LT(angle_deg(found->cup.axis, true_axis(phantom, patient.pose)), 8);
    EXPECT_LT(distance_to_axis(middle_of_cavity(phantom), found->cup), 4);
  }
}

TEST(LocateCup, PrefersAPlainWallToAHotSacThatMayBeOne) {
  const synthetic::Phantom phantom = synthetic::make_phantom(tilted_patient(50));
  Image image = mean_image(phantom.study.gates);
  const float wall = *std::max_element(image.values.begin(), image.values.end());
  // As filtered backprojection shows a gall bladder: many times as hot, flat, dark around. It passes for a small heart.
  const Vec3 middle = to_world(image.grid, Vec3(11, 11, 13)), axes_mm(14, 5.6, 14);
  for (int k = 0; k < image.grid.dims[2]; ++k)
    for (int j = 0; j < image.grid.dims[1]; ++j)
      for (int i = 0; i < image.grid.dims[0]; ++i) {
        const double share = (to_world(image.grid, Vec3(i, j, k)) - middle).cwiseQuotient(axes_mm).norm();
        if (share > 1 && share < 4) image(i, j, k) *= 0.2F;
        const double hot = (share < 1 ? 2 : 4) * std::exp(-std::pow((share - 1) * 3.5, 2));
        image(i, j, k) += wall * static_cast<float>(hot);
      }
  const auto found = locate(image);
  ASSERT_TRUE(found);
  EXPECT_LT(distance_to_axis(middle_of_cavity(phantom), found->cup), 4);
  EXPECT_GT(found->contrast, 0.4);
}

TEST(LocateCup, FindsTheHeartAmongTheOrgansOfAChest) {
  synthetic::VirtualPatient patient;
  patient.gates = 1;
  patient.cut = synthetic::Cut::transaxial;
  patient.torso.present = true;
  patient.torso.liver = 0.9;
  patient.right_ventricle = 0.4;
  patient.lattice = {62, 50, 46, 6.5, 6.5, 6.5};
  patient.pose.offset_x_mm = 40, patient.pose.offset_y_mm = -30, patient.pose.offset_z_mm = 30;
  const synthetic::Phantom phantom = synthetic::make_phantom(patient);
  const auto found = locate(mean_image(phantom.study.gates));
  ASSERT_TRUE(found);
  const TriMesh& epi = phantom.truth.front().epi;
  EXPECT_LT(angle_deg(found->cup.axis, (epi.vertices.back() - epi.vertices.front()).normalized()), 5);
  EXPECT_LT(distance_to_axis(middle_of_cavity(phantom), found->cup), 3);
}

TEST(LocateCup, TellsHowMuchOfTheWallTheVolumeDoesNotHold) {
  const LvShell cup{{50, 50, 50}, {0, 0, 1}, 25, 40, 20};
  Grid grid;
  grid.dims = {51, 51, 51};
  grid.spacing = {2, 2, 2};
  EXPECT_EQ(share_outside(grid, cup), 0);
  grid.dims[0] = 26;  // ends at the axis
  EXPECT_NEAR(share_outside(grid, cup), 0.5, 0.05);
}

}  // namespace
}  // namespace dynasurf::heart
