#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/detail/fill_mesh.hpp"
#include "dynasurf/synthetic/detail/render.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

#include "image_sums.hpp"
#include "mesh_checks.hpp"

namespace dynasurf::synthetic {
namespace {

VirtualPatient clean_patient() {
  VirtualPatient o;
  o.noise.peak_counts = 0;
  o.background = 0;
  o.cavity = 0;
  return o;
}

/// Where the counts of an image lie in the world.
Vec3 centre_of_counts(const Image& image) {
  Vec3 sum{0, 0, 0};
  for (int k = 0; k < image.grid.dims[2]; ++k)
    for (int j = 0; j < image.grid.dims[1]; ++j)
      for (int i = 0; i < image.grid.dims[0]; ++i)
        sum += static_cast<double>(image(i, j, k)) * to_world(image.grid, centre_of(image.grid, {i, j, k}));
  return sum / sum_of(image);
}

/// Mean of a gate over a ball around a point of the world.
double mean_around(const Image& image, const Vec3& world, double radius_mm) {
  double sum = 0, n = 0;
  for (int k = 0; k < image.grid.dims[2]; ++k)
    for (int j = 0; j < image.grid.dims[1]; ++j)
      for (int i = 0; i < image.grid.dims[0]; ++i)
        if ((to_world(image.grid, centre_of(image.grid, {i, j, k})) - world).norm() < radius_mm)
          sum += static_cast<double>(image(i, j, k)), ++n;
  return sum / n;
}

TEST(VirtualPatient, HasTheVolumesAskedFor) {
  for (int gates : {8, 16}) {
    VirtualPatient o = clean_patient();
    o.gates = gates;
    o.edv_ml = 130;
    o.ef_percent = 45;
    o.lattice = {16, 16, 12, 10, 10, 10};
    const Phantom p = make_phantom(o);
    ASSERT_EQ(p.truth.size(), static_cast<std::size_t>(gates));
    // Some gates lie on the level parts of the volume curve, so sampling loses nothing.
    EXPECT_NEAR(p.edv_ml.value(), 130, 1e-3);
    EXPECT_NEAR(p.esv_ml.value(), 130 * 0.55, 1e-3);
    EXPECT_NEAR(p.ef_percent.value(), 45, 1e-3);
    EXPECT_DOUBLE_EQ(p.beat_edv_ml.value(), 130);
    EXPECT_DOUBLE_EQ(p.beat_ef_percent.value(), 45);
  }
}

TEST(VirtualPatient, KeepsItsMuscleVolumeWhileItBeats) {
  VirtualPatient o = clean_patient();
  o.lattice = {16, 16, 12, 10, 10, 10};
  const Phantom p = make_phantom(o);
  for (const TrueGate& gate : p.truth) {
    EXPECT_NEAR(gate.wall_ml(), 120, 1e-6);
    EXPECT_NEAR(signed_volume_ml(gate.epi) - signed_volume_ml(gate.endo), 120, 0.001 * 120);
    EXPECT_NEAR(signed_volume_ml(gate.endo), gate.endo_ml, 5e-4 * gate.endo_ml);
    EXPECT_TRUE(closed_and_oriented(gate.endo));
    EXPECT_TRUE(closed_and_oriented(gate.epi));
  }
}

TEST(VirtualPatient, FillsTheVoxelsWithTheVolumeOfItsMeshes) {
  VirtualPatient o = clean_patient();
  o.fwhm_mm = 0;
  const Phantom p = make_phantom(o);
  for (std::size_t g = 0; g < p.truth.size(); ++g) {
    const Image& image = p.study.gates[g];
    // Without blur the hottest voxel is pure muscle and has the 1000 of a study without counts.
    const double filled_ml = sum_of(image) / 1000 * image.grid.voxel_volume_mm3() / 1000;
    EXPECT_NEAR(filled_ml, p.truth[g].wall_ml(), 0.005 * 120);
    // And voxel by voxel, by the other way of filling.
    const Index3 sub{5, 5, 5};
    const Image epi = mesh::fill_mesh(image.grid, to_grid(image.grid, p.truth[g].epi), sub);
    const Image endo = mesh::fill_mesh(image.grid, to_grid(image.grid, p.truth[g].endo), sub);
    EXPECT_NEAR((sum_of(epi) - sum_of(endo)) * image.grid.voxel_volume_mm3() / 1000, 120, 0.005 * 120);
    double difference = 0;
    for (std::size_t v = 0; v < image.values.size(); ++v)
      difference +=
          std::abs(static_cast<double>(image.values[v]) / 1000 - static_cast<double>(epi.values[v] - endo.values[v]));
    // Sub-samples of 1 mm decide alone which side of a surface they are on: a few per cent of the muscle's voxels.
    EXPECT_LT(difference, 0.04 * sum_of(image) / 1000) << g;
  }
}

TEST(VirtualPatient, LiesWhereItsMeshesLieInAnyPose) {
  VirtualPatient o = clean_patient();
  o.pose = {9, -6, 4, 15, 60};
  o.azimuth_deg = 30;
  o.elevation_deg = 40;
  for (bool base_first : {false, true}) {
    o.base_first = base_first;
    const Phantom p = make_phantom(o);
    const TrueGate& gate = p.truth.front();
    const double epi = signed_volume_ml(gate.epi), endo = signed_volume_ml(gate.endo);
    const Vec3 muscle = (epi * centroid_of(gate.epi) - endo * centroid_of(gate.endo)) / (epi - endo);
    EXPECT_LT((centre_of_counts(p.study.gates.front()) - muscle).norm(), 0.1) << base_first;
    EXPECT_GT(epi, 0) << "surfaces stay right side out on left-handed grids";
    EXPECT_EQ(p.study.slice_order, base_first ? SliceOrder::base_to_apex : SliceOrder::apex_to_base);
  }
}

TEST(VirtualPatient, PointsItsApexToTheLeftForwardAndDown) {
  const Phantom p = make_phantom(clean_patient());
  const Mat3& d = p.study.grid().direction;
  EXPECT_NEAR((d.transpose() * d - Mat3::Identity()).norm(), 0, 1e-12);
  EXPECT_NEAR(d.determinant(), 1, 1e-12);
  const Vec3 to_apex = -d.col(2);
  EXPECT_GT(to_apex[0], 0.3);   // left
  EXPECT_LT(to_apex[1], -0.3);  // forward
  EXPECT_LT(to_apex[2], -0.3);  // down
  EXPECT_LT(d.col(1)[2], -0.5) << "rows run from anterior, which is up, to inferior";
  EXPECT_GT(d.col(0)[0], 0.5) << "columns run from the septum, which is right, to the lateral wall";
}

TEST(VirtualPatient, StoresTheSameVoxelsFromTheOtherEnd) {
  VirtualPatient o = clean_patient();
  const Phantom apex_first = make_phantom(o);
  o.base_first = true;
  const Phantom base_first = make_phantom(o);
  const Image &a = apex_first.study.gates[0], &b = base_first.study.gates[0];
  for (int k = 0; k < a.grid.dims[2]; ++k) {
    const int back = a.grid.dims[2] - 1 - k;
    EXPECT_EQ(a(20, 30, k), b(20, 30, back));
    EXPECT_LT(
        (to_world(a.grid, centre_of(a.grid, {20, 30, k})) - to_world(b.grid, centre_of(b.grid, {20, 30, back}))).norm(),
        1e-9);
  }
}

TEST(VirtualPatient, IsAGatedNuclearStudyWithTimes) {
  VirtualPatient o;
  o.heart_rate_bpm = 60;
  const Phantom p = make_phantom(o);
  EXPECT_EQ(p.kind, "patient");
  EXPECT_EQ(p.study.format, "synthetic");
  EXPECT_EQ(p.study.modality, "NM");
  EXPECT_EQ(p.study.image_type, "RECON GATED TOMO");
  EXPECT_EQ(p.study.view, View::short_axis);
  EXPECT_EQ(p.study.gates.size(), 8u);
  EXPECT_EQ(p.study.grid().dims, (Index3{64, 64, 23}));
  EXPECT_DOUBLE_EQ(p.study.cycle_ms, 1000);
  EXPECT_DOUBLE_EQ(p.study.time_ms.at(3), 375);
  EXPECT_DOUBLE_EQ(p.truth.at(3).phase, 0.4375);
  o.gates = 1;
  const Phantom still = make_phantom(o);
  EXPECT_EQ(still.study.image_type, "RECON TOMO");
  EXPECT_FALSE(still.ef_percent.has_value());
  EXPECT_NEAR(still.truth.at(0).endo_ml, o.edv_ml, 1e-9);
}

TEST(VirtualPatient, CountsTheFilterAsPartOfThePointSpread) {
  VirtualPatient o = clean_patient();
  o.gates = 1;
  const Image direct = make_phantom(o).study.gates[0];
  o.noise = {1e7, 8, 0, 1};  // so many counts that their noise is below one part in a thousand
  const Image filtered = make_phantom(o).study.gates[0];
  const float top_direct = *std::max_element(direct.values.begin(), direct.values.end());
  const float top_filtered = *std::max_element(filtered.values.begin(), filtered.values.end());
  double worst = 0;
  for (std::size_t v = 0; v < direct.values.size(); ++v)
    worst = std::max(worst, std::abs(static_cast<double>(direct.values[v] / top_direct) -
                                     static_cast<double>(filtered.values[v] / top_filtered)));
  // The filter works on slices 5.74 mm apart, too far for its shape though not for its width. Were it added to the
  // point spread instead, the difference would be 0.14.
  EXPECT_LT(worst, 0.03);
}

TEST(VirtualPatient, NarrowsAFilterThatIsWiderThanThePointSpreadAndSaysSo) {
  VirtualPatient o;
  o.fwhm_mm = 5;
  const Phantom p = make_phantom(o);
  ASSERT_EQ(p.notes.size(), 1u);
  EXPECT_EQ(p.notes[0].code, "phantom.filter_narrowed");
  EXPECT_DOUBLE_EQ(std::get<VirtualPatient>(p.options).noise.filter_fwhm_mm, 5);
}

TEST(VirtualPatient, HasNoiseOfVarianceEqualToItsMeanBeforeAndLessButSharedAfterTheFilter) {
  VirtualPatient o;
  o.edv_ml = 20;
  o.wall_ml = 20;  // a small heart leaves much even background
  o.background = 0.5;
  o.gates = 2;
  for (double filter : {0.0, 8.0}) {
    o.noise.filter_fwhm_mm = filter;
    const Image image = make_phantom(o).study.gates[0];
    std::vector<double> left, right;
    for (int k = 2; k < 21; ++k)
      for (int j = 2; j < 62; ++j)
        for (int i : {3, 6, 9, 52, 55, 58}) {
          left.push_back(static_cast<double>(image(i, j, k)));
          right.push_back(static_cast<double>(image(i + 1, j, k)));
        }
    double mean = 0, variance = 0, shared = 0;
    for (double v : left) mean += v / static_cast<double>(left.size());
    for (std::size_t n = 0; n < left.size(); ++n) {
      variance += (left[n] - mean) * (left[n] - mean) / static_cast<double>(left.size());
      shared += (left[n] - mean) * (right[n] - mean) / static_cast<double>(left.size());
    }
    if (filter == 0) {
      // 6840 voxels: the variance is known to 1.7 %, the correlation to 0.012; three to four times that.
      EXPECT_NEAR(variance / mean, 1, 0.06);
      EXPECT_NEAR(shared / variance, 0, 0.05);
    } else {
      // Sums of squares of the discrete Gaussian's weights: 0.239 twice and 0.53; neighbours share exp(-d^2 / 4 s^2).
      const double s = sigma_of_fwhm(filter) / 2.87;
      EXPECT_LT(variance / mean, 0.05);
      EXPECT_NEAR(shared / variance, std::exp(-1 / (4 * s * s)), 0.06);
    }
  }
}

TEST(VirtualPatient, ReachesThePeakCountsAskedFor) {
  VirtualPatient o;
  o.noise = {400, 0, 0, 3};
  const Phantom p = make_phantom(o);
  float hottest = 0;
  for (const Image& image : p.study.gates)
    hottest = std::max(hottest, *std::max_element(image.values.begin(), image.values.end()));
  // The hottest of many draws around 400 lies a few standard deviations (20) above it.
  EXPECT_GT(hottest, 400.0f);
  EXPECT_LT(hottest, 520.0f);
}

TEST(VirtualPatient, GivesTheSameBytesForAnyThreadCountAndOthersForAnotherSeed) {
  VirtualPatient o;
  o.noise.gaussian_percent = 1;
  std::vector<std::vector<float>> images;
  for (int threads : {1, 2, 4, 8}) {
    const ThreadLimit limit(threads);
    images.push_back(make_phantom(o).study.gates[5].values);
    EXPECT_EQ(images.back(), images.front()) << threads;
  }
  o.noise.gaussian_percent = 0;  // the counts alone must follow the seed, too
  const Phantom first = make_phantom(o);
  o.noise.seed = 2;
  EXPECT_NE(make_phantom(o).study.gates[5].values, first.study.gates[5].values);
}

TEST(VirtualPatient, GetsBrighterWallsInSystoleThroughThePartialVolumeEffect) {
  const Phantom p = make_phantom(clean_patient());
  const auto peak = [&](std::size_t g) {
    return *std::max_element(p.study.gates[g].values.begin(), p.study.gates[g].values.end());
  };
  EXPECT_GT(peak(3) / peak(0), 1.1f);
  EXPECT_LT(peak(3) / peak(0), 1.6f);
}

TEST(VirtualPatient, LosesCountsWhereTheDefectIsAndOnlyThere) {
  struct Case {
    Defect defect;
    Vec3 towards;
  };
  VirtualPatient o = clean_patient();
  o.gates = 1;
  const Phantom healthy = make_phantom(o);
  const Grid& grid = healthy.study.grid();
  const Vec3 middle = centroid_of(healthy.truth[0].endo);
  for (const auto& [defect, towards] :
       {Case{Defect::lateral, {1, 0, 0}}, Case{Defect::inferior, {0, 1, 0}}, Case{Defect::septal, {-1, 0, 0}},
        Case{Defect::apical, {0, 0, -1}}, Case{Defect::anteroapical, {0, -1, 0}}}) {
    o.defect = defect;
    const Phantom sick = make_phantom(o);
    // Half axes of the middle of the wall of this default heart.
    const Vec3 reach{30, 30, 57};
    const auto ratio = [&](const Vec3& direction) {
      const Vec3 place = middle + grid.direction * direction.cwiseProduct(reach);
      return mean_around(sick.study.gates[0], place, 6) / mean_around(healthy.study.gates[0], place, 6);
    };
    EXPECT_LT(ratio(towards), 0.5) << word_of(defect);
    const Vec3 opposite = defect == Defect::apical ? Vec3(1, 0, 0) : Vec3(-towards);
    EXPECT_GT(ratio(opposite), 0.85) << word_of(defect);
  }
}

TEST(VirtualPatient, ShowsGutBelowAndARightVentricleBesideTheHeart) {
  VirtualPatient o = clean_patient();
  o.gates = 1;
  const Phantom plain = make_phantom(o);
  o.gut_amplitude = 1.2;
  const Phantom gut = make_phantom(o);
  o.gut_amplitude = 0;
  o.right_ventricle = 0.4;
  const Phantom right = make_phantom(o);
  const Mat3& d = plain.study.grid().direction;
  const auto shift = [&](const Phantom& p) -> Vec3 {
    return d.transpose() * (centre_of_counts(p.study.gates[0]) - centre_of_counts(plain.study.gates[0]));
  };
  EXPECT_GT(shift(gut)[1], 3) << "towards inferior";
  EXPECT_NEAR(shift(gut)[0], 0, 0.5);
  EXPECT_LT(shift(right)[0], -1) << "towards the septum";
  EXPECT_NEAR(shift(right)[1], 0, 0.5);
}

TEST(VirtualPatient, RefusesNonsense) {
  VirtualPatient o;
  o.edv_ml = -1;
  EXPECT_THROW(make_phantom(o), OptionError);
  o = {};
  o.gates = 0;
  EXPECT_THROW(make_phantom(o), OptionError);
  o = {};
  o.fwhm_mm = std::nan("");
  EXPECT_THROW(make_phantom(o), OptionError);
}

TEST(VirtualPatient, LiesInTheSamePlaceOfTheWorldHoweverItIsCut) {
  VirtualPatient o = clean_patient();
  o.gates = 1;
  o.lattice = {40, 40, 40, 5, 5, 5};
  const Phantom square = make_phantom(o);
  o.cut = Cut::transaxial;
  const Phantom across = make_phantom(o);
  EXPECT_EQ(across.study.view, View::transaxial);
  EXPECT_EQ(across.study.slice_order, SliceOrder::unknown);
  EXPECT_EQ(across.study.grid().direction, Mat3::Identity());
  for (std::size_t v = 0; v < square.truth[0].epi.vertices.size(); v += 501)
    EXPECT_LT((square.truth[0].epi.vertices[v] - across.truth[0].epi.vertices[v]).norm(), 1e-9);
  // Both see the same counts in the same place; the samples of the two lattices differ by some tenths of a millimetre.
  EXPECT_LT((centre_of_counts(square.study.gates[0]) - centre_of_counts(across.study.gates[0])).norm(), 0.5);
}

TEST(VirtualPatient, HasOrgansAroundTheHeartAndNothingOutsideTheSkin) {
  VirtualPatient o = clean_patient();
  o.gates = 1;
  o.background = 0.05;
  o.fwhm_mm = 8;
  o.cut = Cut::transaxial;
  o.torso.present = true;
  o.torso.liver = 0.7, o.torso.lung = 0.3, o.torso.gallbladder = 2;
  o.lattice = {60, 50, 60, 7, 7, 7};
  o.pose.offset_x_mm = 50, o.pose.offset_y_mm = -40, o.pose.offset_z_mm = 50;
  const Phantom p = make_phantom(o);
  const Vec3 heart{45, -35, 10};
  const Image& image = p.study.gates[0];
  // Places well within an organ, so that blur does not reach them; counts are scaled by their maximum.
  const double liver = mean_around(image, heart + Vec3(-120, 15, -95), 10);
  EXPECT_NEAR(mean_around(image, heart + Vec3(-130, 30, 70), 10) / liver, 0.3 / 0.7, 0.01);
  EXPECT_GT(mean_around(image, heart + Vec3(-70, -55, -115), 6) / liver, 1.5 / 0.7) << "a small gallbladder, blurred";
  EXPECT_NEAR(mean_around(image, heart + Vec3(-45, -130, 60), 8) / liver, 0, 0.01) << "in front of the chest";
  EXPECT_NEAR(mean_around(image, heart + Vec3(-45, 130, 20), 8) / liver, 0.05 / 0.7, 0.01) << "the back";
}

VirtualPatient small_patient() {
  VirtualPatient o;
  o.gates = 2;
  o.noise.peak_counts = 0;
  o.lattice = {32, 32, 28, 4.5, 4.5, 4.5};
  return o;
}

TEST(IrregularPatient, KeepsItsTruthInItsImage) {
  // Without blur and blood the wall's voxels sum up to the volume between the two true meshes.
  VirtualPatient o = small_patient();
  o.fwhm_mm = 0, o.cavity = 0, o.background = 0;
  const auto muscle_of = [](const Phantom& phantom) {
    double sum = 0, most = 0;
    for (const float v : phantom.study.gates[0].values) {
      sum += static_cast<double>(v);
      most = std::max(most, static_cast<double>(v));
    }
    return sum / most * phantom.study.grid().voxel_volume_mm3() / 1000;
  };
  const double plain = muscle_of(make_phantom(o));
  o.irregular.walls = 1;
  const Phantom uneven = make_phantom(o);
  // Thirty voxels across and sub-samples of 1.2 mm hold a wall of 10 mm to within 2 %.
  EXPECT_NEAR(muscle_of(uneven) / uneven.truth[0].wall_ml(), 1, 0.02);
  EXPECT_GT(std::abs(muscle_of(uneven) - plain), 1);
  o.irregular.papillary_mm = 4;
  EXPECT_GT(muscle_of(make_phantom(o)), muscle_of(uneven) + 1);  // two rods of 4 mm across some 30 mm: 3 mL
}

TEST(IrregularPatient, KeepsItsMuscleOverTheBeatWithinWhatAtlasesShow) {
  VirtualPatient o = small_patient();
  o.gates = 8;
  o.irregular.walls = 1;
  const Phantom phantom = make_phantom(o);
  double least = 1e9, most = 0;
  for (const TrueGate& gate : phantom.truth)
    least = std::min(least, gate.wall_ml()), most = std::max(most, gate.wall_ml());
  EXPECT_LT(most / least, 1.06);
}

TEST(IrregularPatient, SeesFarRowsMoreBlurred) {
  VirtualPatient o = small_patient();
  const Image even = make_phantom(o).study.gates[0];
  o.irregular.depth = 0.2;
  const Image uneven = make_phantom(o).study.gates[0];
  const auto steepest = [](const Image& image, int from, int to) {
    float most = 0;
    for (int k = 0; k < image.grid.dims[2]; ++k)
      for (int j = from; j < to; ++j)
        for (int i = 1; i < image.grid.dims[0]; ++i) most = std::max(most, image(i, j, k) - image(i - 1, j, k));
    return most;
  };
  EXPECT_GT(steepest(uneven, 0, 14), steepest(even, 0, 14));
  EXPECT_LT(steepest(uneven, 18, 32), steepest(even, 18, 32));
}

TEST(IrregularPatient, TailsTakeCountsOutOfTheWall) {
  VirtualPatient o = small_patient();
  o.background = 0;
  const Image even = make_phantom(o).study.gates[0];
  o.irregular.tails = 0.3;
  const Image tailed = make_phantom(o).study.gates[0];
  // Both studies have their hottest voxel at 1000: with tails more of the rest is bright.
  double sum = 0, with_tails = 0;
  for (std::size_t v = 0; v < even.values.size(); ++v)
    sum += static_cast<double>(even.values[v]), with_tails += static_cast<double>(tailed.values[v]);
  EXPECT_GT(with_tails, 1.1 * sum);
}

TEST(Tags, FollowTheMuscleAndTurnWithTheTwist) {
  VirtualPatient o = small_patient();
  o.gates = 8;
  EXPECT_FALSE(make_phantom(o).tracked);
  o.tags = {.points = 60, .twist_deg = 20, .error_mm = 0};
  const Phantom turned = make_phantom(o);
  o.tags.twist_deg = 0;
  const Phantom straight = make_phantom(o);
  ASSERT_TRUE(turned.tracked && straight.tracked);
  ASSERT_EQ(turned.tracked->points.gates.size(), 8u);
  EXPECT_EQ(turned.study.gates[4].values, straight.study.gates[4].values);  // no image shows it
  const auto systole =
      static_cast<std::size_t>(std::max_element(turned.tracked->twist_deg.begin(), turned.tracked->twist_deg.end()) -
                               turned.tracked->twist_deg.begin());
  EXPECT_GT(turned.tracked->twist_deg[systole], 18);
  EXPECT_DOUBLE_EQ(turned.tracked->twist_deg[0], 0);
  const Vec3 apex = turned.tracked->apex, up = (turned.tracked->base - apex).normalized();
  EXPECT_NEAR(up.dot(*turned.axis), 1, 1e-12);
  for (std::size_t n = 0; n < 60; ++n) {
    const Vec3 a = straight.tracked->points.gates[systole][n] - apex,
               b = turned.tracked->points.gates[systole][n] - apex;
    EXPECT_NEAR(a.dot(up), b.dot(up), 1e-9);
    const Vec3 across = a - a.dot(up) * up, there = b - b.dot(up) * up;
    EXPECT_NEAR(across.norm(), there.norm(), 1e-9);
    const double height = (turned.tracked->points.gates[0][n] - apex).dot(up) / (turned.tracked->base - apex).norm();
    const double angle =
        std::atan2(-up.dot(across.cross(there)), across.dot(there)) * 180 / M_PI;  // seen from the apex
    EXPECT_NEAR(angle, turned.tracked->twist_deg[systole] * (0.7 - height), 0.3);  // the first gate is all but at rest
  }
}

TEST(NoiseTexture, TakesTheSlowWavesOutOfTheNoise) {
  VirtualPatient o = small_patient();
  o.noise.filter_fwhm_mm = 0;
  const Image mean = make_phantom(o).study.gates[0];
  const auto slow_noise = [&](double texture) {
    VirtualPatient p = o;
    p.noise.peak_counts = 1000, p.noise.texture = texture;
    Image noise = make_phantom(p).study.gates[0];
    for (std::size_t v = 0; v < noise.values.size(); ++v) noise.values[v] -= mean.values[v];
    noise = blur(noise, 36);  // eight voxels: twice as slow as what is taken out
    double squares = 0;
    for (const float v : noise.values) squares += static_cast<double>(v * v);
    return std::sqrt(squares);
  };
  // White noise keeps 0.34 of it by the two Gaussians' integrals.
  EXPECT_LT(slow_noise(0.8), 0.5 * slow_noise(0));
}

}  // namespace
}  // namespace dynasurf::synthetic
