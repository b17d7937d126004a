#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/synthetic/detail/voxel_truth.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

#include "image_sums.hpp"
#include "mesh_checks.hpp"

namespace dynasurf::synthetic {
namespace {

double total_ml(const Phantom& p) { return sum_of(p.study.gates[0]) / 1000 * p.study.grid().voxel_volume_mm3() / 1000; }

TEST(Hebron, HasTheAnalyticVolumesOfTheThesis) {
  const Phantom p = make_phantom(Hebron{});
  EXPECT_EQ(p.kind, "hebron");
  EXPECT_EQ(p.study.image_type, "RECON TOMO");
  ASSERT_EQ(p.truth.size(), 1u);
  EXPECT_NEAR(1000 * p.truth[0].epi_ml, 301461.995, 0.001);
  EXPECT_NEAR(1000 * p.truth[0].endo_ml, 85870.199, 0.001);
  EXPECT_NEAR(signed_volume_ml(p.truth[0].epi), p.truth[0].epi_ml, 0.15);
  EXPECT_NEAR(signed_volume_ml(p.truth[0].endo), p.truth[0].endo_ml, 0.05);
}

TEST(Hebron, GivesTheVoxelCountsOfTheCalibration) {
  // Calibration of the thesis's data: 7772 filled voxels at sigma 3 mm (published: 7800) and a cavity of 980 at 5 mm
  // (published: 906). Those came from a blur on the coarse grid, a few per cent narrower along k; 1 % allows for it.
  Hebron o;
  o.sigma_mm = 3;
  EXPECT_NEAR(count_voxels(filled_solid(make_phantom(o).study.gates[0])), 7772, 0.01 * 7772);
  o.sigma_mm = 5;
  EXPECT_NEAR(count_voxels(enclosed_cavity(make_phantom(o).study.gates[0])), 980, 0.01 * 980);
}

TEST(Hebron, TakesTheCoverOfTheThesis) {
  const Mask solid = filled_solid(make_phantom(Hebron{}).study.gates[0]);
  const Mask disc = image::cover_disc(solid, 33.66);
  EXPECT_EQ(count_voxels(disc), 432u);  // 20425 mm3 of the thesis
  EXPECT_NEAR(1000 * voxel_volume_ml(disc), 20425, 1);
  EXPECT_EQ(count_voxels(image::unite(solid, disc)), count_voxels(solid) + 432);
}

TEST(Hebron, ConvergesToItsAnalyticVolumeOnFinerGrids) {
  Hebron o;
  o.sigma_mm = 0;
  double last = 1e9;
  for (int n : {1, 2, 4}) {
    o.lattice = {32 * n, 32 * n, 12 * n, 5.74 / n, 5.74 / n, 11.48 / n};
    const double error = std::abs(total_ml(make_phantom(o)) - 215.591796);
    EXPECT_LT(error, std::max(0.5 * last, 0.02)) << n;
    last = error;
  }
  EXPECT_LT(last, 0.001 * 215.6);
}

TEST(Hebron, CanBeCoveredMovedTiltedDoubledAndMadeBinary) {
  Hebron o;
  const Phantom plain = make_phantom(o);

  o.cover = true;
  EXPECT_GT(sum_of(make_phantom(o).study.gates[0]), 1.05 * sum_of(plain.study.gates[0]));
  o = {};

  o.pose.offset_x_mm = 2 * 2.87;
  const Phantom moved = make_phantom(o);
  // Sub-samples fall elsewhere against the wall: a thousandth of the maximum of 1000.
  for (int i = 10; i < 50; ++i) EXPECT_NEAR(moved.study.gates[0](i + 2, 31, 10), plain.study.gates[0](i, 31, 10), 1.5f);
  EXPECT_NEAR(centroid_of(moved.truth[0].epi)[0] - centroid_of(plain.truth[0].epi)[0], 5.74, 1e-9);
  o = {};

  o.pose.tilt_deg = 30;
  o.pose.tilt_towards_deg = 90;
  const TriMesh tilted = make_phantom(o).truth[0].epi;
  const Vec3 axis = (tilted.vertices.back() - tilted.vertices.front()).normalized();
  EXPECT_LT((axis - Vec3(0, 0.5, std::sqrt(0.75))).norm(), 1e-9) << "the base leans towards +j";
  o = {};

  o.doubled = true;
  const Phantom doubled = make_phantom(o);
  EXPECT_EQ(doubled.study.grid().dims, (Index3{128, 128, 46}));
  EXPECT_NEAR(sum_of(doubled.study.gates[0]) / 8, sum_of(plain.study.gates[0]), 0.001 * sum_of(plain.study.gates[0]));
  const Grid &fine = doubled.study.grid(), &coarse = plain.study.grid();
  const Vec3 low = to_world(fine, -fine.spacing / 2), low_before = to_world(coarse, -coarse.spacing / 2);
  EXPECT_LT((low - low_before).norm(), 1e-9) << "the outer corner of the grid stays";
  o = {};

  o.values = Values::binary;
  const Phantom binary = make_phantom(o);
  const Mask wall = filled_solid(binary.study.gates[0], 0.5), from_grey = filled_solid(plain.study.gates[0], 0.2);
  EXPECT_EQ(wall.values, from_grey.values);
  for (float v : binary.study.gates[0].values) EXPECT_TRUE(v == 0.0f || v == 1.0f);
}

TEST(Hebron, RefusesAnInnerWallOutsideTheOuterOne) {
  Hebron o;
  o.shape.inner_radius_mm = 36;
  EXPECT_THROW(make_phantom(o), OptionError);
}

TEST(Borders, AreOneVoxelThickAndEncloseTheSolid) {
  const Image image = make_phantom(Hebron{}).study.gates[0];
  const Mask solid = filled_solid(image);
  const Image border = external_border(image);
  for (int k = 0; k < image.grid.dims[2]; ++k)
    for (int j = 0; j < image.grid.dims[1]; ++j)
      for (int i = 0; i < image.grid.dims[0]; ++i) {
        if (solid(i, j, k) == 0) {
          EXPECT_EQ(border(i, j, k), 0.0f);
          continue;
        }
        const bool touches = !solid.clamped(i + 1, j, k) || !solid.clamped(i - 1, j, k) ||
                             !solid.clamped(i, j + 1, k) || !solid.clamped(i, j - 1, k) ||
                             !solid.clamped(i, j, k + 1) || !solid.clamped(i, j, k - 1);
        EXPECT_EQ(border(i, j, k) == 1.0f, touches);
      }
  const double shell = sum_of(border), inner = sum_of(internal_border(image));
  EXPECT_GT(shell, 1000);
  EXPECT_GT(inner, 100);
  EXPECT_LT(inner, shell);
  EXPECT_GT(sum_of(external_border(image, 0.2, 33.66)), shell) << "the rim of the cover adds voxels";
}

TEST(Borders, TakeOnlyWhatIsClosedInItsSliceForACavity) {
  Grid grid;
  grid.dims = {7, 7, 4};
  // Four rings around the middle, each open towards another side of the slice and reaching its edge there.
  Image image(grid);
  for (int k = 0; k < 4; ++k)
    for (int n = 0; n < 7; ++n)
      for (int side : {2, 4}) (k < 2 ? image(n, side, k) : image(side, n, k)) = 1;
  for (int n = 2; n <= 4; ++n) image(0, n, 0) = image(6, n, 1) = image(n, 0, 2) = image(n, 6, 3) = 1;
  EXPECT_EQ(count_voxels(enclosed_cavity(image)), 0u);
  image(6, 3, 0) = image(0, 3, 1) = image(3, 6, 2) = image(3, 0, 3) = 1;
  EXPECT_EQ(count_voxels(enclosed_cavity(image)), 4u * 5u);
  EXPECT_EQ(count_voxels(filled_solid(image)), 4u * (7u + 7u + 2u + 5u));
}

TEST(Borders, OfNothingAreEmpty) {
  Grid grid;
  grid.dims = {5, 5, 5};
  const Image nothing(grid);
  EXPECT_EQ(count_voxels(filled_solid(nothing)), 0u);
  EXPECT_EQ(sum_of(external_border(nothing, 0.2, 3)), 0);
  EXPECT_EQ(count_voxels(image::cover_disc(Mask(grid, 1), 2)), 0u) << "no slice above the highest";
}

TEST(Mayo, HasThePublishedVolumeOnItsCoarseVoxels) {
  const Phantom p = make_phantom(Mayo{});
  EXPECT_NEAR(1000 * p.truth[0].epi_ml, 265501, 0.01);
  EXPECT_DOUBLE_EQ(p.study.grid().spacing[2], 5.388);
  EXPECT_NEAR(p.truth[0].endo_ml / p.truth[0].epi_ml, 85870.199 / 301461.995, 1e-9);
}

TEST(Partial, LacksThePartOfTheWallAskedFor) {
  Partial o;
  o.base.sigma_mm = 0;
  o.fraction = 0;
  const double whole = total_ml(make_phantom(o));
  for (Missing missing : {Missing::sector, Missing::patch, Missing::apex})
    for (double fraction : {0.10, 0.20, 0.32, 0.53}) {
      if (missing == Missing::patch && fraction > 0.3) continue;
      for (int pieces : {1, 3}) {
        o.missing = missing;
        o.fraction = fraction;
        o.pieces = pieces;
        const Phantom p = make_phantom(o);
        EXPECT_DOUBLE_EQ(p.missing_fraction, fraction);
        // A sub-sample is 1.08 mm of a wall 14.4 mm thick and 86 mm high: the apex's cut may be off by one layer.
        const double one_layer = missing == Missing::apex ? 1.08 / 86 : 0.002;
        EXPECT_NEAR(1 - total_ml(p) / whole, fraction, one_layer) << word_of(missing) << " " << pieces;
      }
    }
}

TEST(Partial, LacksItWhereAsked) {
  Partial o;
  o.towards_deg = 90;
  o.fraction = 0.1;
  const Image image = make_phantom(o).study.gates[0];
  const int i = 32, k = 12;
  const int wall = static_cast<int>(26.4 / 5.388 + 0.5);
  EXPECT_LT(image(i, 31 + wall, k), 0.5f * image(i, 31 - wall, k));
}

TEST(Partial, RefusesAPatchLargerThanItsBand) {
  Partial o;
  o.missing = Missing::patch;
  o.fraction = 0.9;
  EXPECT_THROW(make_phantom(o), OptionError);
}

TEST(Gap, LosesTheMiddleThird) {
  Gap o;
  const Phantom gap = make_phantom(o), whole = make_phantom(o.base);
  const Image &a = gap.study.gates[0], &b = whole.study.gates[0];
  // The wall's ring at the middle slice is gone, at both ends it is as before.
  const int ring = 31 + static_cast<int>(27.5 / 2.87);
  EXPECT_LT(a(ring, 31, 11), 0.05f * b(ring, 31, 11));
  EXPECT_NEAR(a(ring, 31, 17), b(ring, 31, 17), 0.05f * b(ring, 31, 17));
  o.base.sigma_mm = 0;
  const double part = 1 - total_ml(make_phantom(o)) / total_ml(make_phantom(o.base));
  EXPECT_NEAR(part, gap.missing_fraction, 1.15 / 30);
}

TEST(CardiacCycle, HasTheCavitiesOfTheTable) {
  const double cavities[] = {74741, 45677, 36523, 32956, 47237, 55825, 63133, 79581};
  const double walls[] = {369021, 271127, 217589, 217175, 252542, 290005, 388392, 394027};
  CardiacCycle o;
  const Phantom constant = make_phantom(o);
  o.wall = WallVolume::published;
  const Phantom published = make_phantom(o);
  ASSERT_EQ(constant.truth.size(), 8u);
  EXPECT_EQ(constant.study.grid().dims, (Index3{64, 64, 24}));
  for (std::size_t g = 0; g < 8; ++g) {
    EXPECT_NEAR(1000 * constant.truth[g].endo_ml, cavities[g], 1e-3);
    EXPECT_NEAR(constant.truth[g].wall_ml(), 215.591796, 1e-6);
    EXPECT_NEAR(1000 * published.truth[g].wall_ml(), walls[g], 1e-3);
    EXPECT_NEAR(signed_volume_ml(published.truth[g].epi), published.truth[g].epi_ml, 1e-3 * published.truth[g].epi_ml);
  }
  EXPECT_NEAR(constant.ef_percent.value(), 58.6, 0.05);
}

TEST(CardiacCycle, FitsIntoItsGrid) {
  CardiacCycle o;
  o.wall = WallVolume::published;
  const Phantom p = make_phantom(o);
  for (const Image& image : p.study.gates)
    for (int k : {0, image.grid.dims[2] - 1}) {
      float most = 0;
      for (int j = 0; j < 64; ++j)
        for (int i = 0; i < 64; ++i) most = std::max(most, image(i, j, k));
      EXPECT_LT(most, 20.0f) << "of 1000, slice " << k;
    }
}

TEST(Spheres, ReadTenHighVoxelsTwiceAlongTheCentralLine) {
  const Phantom p = make_phantom(TwoSpheres{});
  const Image& image = p.study.gates[0];
  std::vector<int> runs;
  int run = 0;
  for (int i = 0; i < 50; ++i) {
    if (image(i, 24, 24) == 1.0f) ++run;
    if (run > 0 && (image(i, 24, 24) == 0.0f || i == 49)) runs.push_back(run), run = 0;
  }
  EXPECT_EQ(runs, (std::vector<int>{10, 10}));
  EXPECT_NEAR(sum_of(image), 4.0 / 3 * M_PI * (18 * 18 * 18 - 8 * 8 * 8), 0.01 * 24000);
}

TEST(VoxelSphere, IsFilledAndHasNoCavity) {
  const Phantom p = make_phantom(VoxelSphere{});
  EXPECT_EQ(p.study.gates[0](16, 16, 16), 1.0f);
  EXPECT_NEAR(sum_of(p.study.gates[0]), 4188.8, 42);
  EXPECT_TRUE(p.truth[0].endo.vertices.empty());
  EXPECT_NEAR(signed_volume_ml(p.truth[0].epi), 4.1888, 0.004);
}

float at_angle(const Image& image, double deg, double radius_mm, int k) {
  const double a = deg * M_PI / 180;
  return image(static_cast<int>(std::lround(31.5 + radius_mm * std::cos(a) / 2.87)),
               static_cast<int>(std::lround(31.5 + radius_mm * std::sin(a) / 2.87)), k);
}

TEST(Pathology, LosesUptakeInTheTerritoryOfTheOcclusion) {
  const Image healthy = make_phantom(Hebron{}).study.gates[0];
  struct Case {
    Disease disease;
    double sick_deg, healthy_deg;
  };
  for (const auto& c :
       {Case{Disease::inferior, 90, 270}, Case{Disease::lateral, 0, 180}, Case{Disease::anteroapical, 270, 90}}) {
    Pathology o;
    o.disease = c.disease;
    const Image image = make_phantom(o).study.gates[0];
    EXPECT_LT(at_angle(image, c.sick_deg, 27.5, 14), 0.4f * at_angle(healthy, c.sick_deg, 27.5, 14));
    EXPECT_GT(at_angle(image, c.healthy_deg, 27.5, 14), 0.95f * at_angle(healthy, c.healthy_deg, 27.5, 14));
  }
  // The outermost wall at the apex: z = -27 mm, slice (53.1 + 10 - 27 - 10) / 5.74.
  for (Disease disease : {Disease::apical, Disease::anteroapical}) {
    Pathology o;
    o.disease = disease;
    EXPECT_LT(make_phantom(o).study.gates[0](31, 31, 4), 0.4f * healthy(31, 31, 4)) << word_of(disease);
  }
}

TEST(Pathology, AddsActivityBesideTheHeart) {
  const Image healthy = make_phantom(Hebron{}).study.gates[0];
  Pathology o;
  o.disease = Disease::digestive;
  const Image gut = make_phantom(o).study.gates[0];
  EXPECT_GT(sum_of(gut), 1.03 * sum_of(healthy));
  EXPECT_GT(gut(31, 31 + 8, 2), 300.0f) << "below the apex, towards the inferior side";
  EXPECT_LT(healthy(31, 31 + 8, 2), 100.0f);

  o.disease = Disease::right_ventricle;
  o.amplitude = 0.4;
  const Image right = make_phantom(o).study.gates[0];
  EXPECT_GT(at_angle(right, 180, 52, 14), 100.0f);
  EXPECT_LT(at_angle(right, 0, 52, 14), 20.0f);
}

TEST(Pathology, ShowsTheBloodPoolInstead) {
  Pathology o;
  o.disease = Disease::muga;
  const Image image = make_phantom(o).study.gates[0];
  EXPECT_GT(image(31, 31, 14), 900.0f);
  EXPECT_LT(at_angle(image, 0, 27.5, 14), 300.0f);
}

TEST(Phantoms, OfTheVariantAreMadeByName) {
  for (const PhantomOptions& options :
       {PhantomOptions{Hebron{}}, PhantomOptions{Mayo{}}, PhantomOptions{Partial{}}, PhantomOptions{TwoSpheres{}},
        PhantomOptions{VoxelSphere{}}, PhantomOptions{Gap{}}, PhantomOptions{CardiacCycle{}},
        PhantomOptions{Pathology{}}, PhantomOptions{VirtualPatient{}}}) {
    const Phantom p = make_phantom(options);
    EXPECT_EQ(p.kind, std::visit([](const auto& o) { return o.name; }, options));
    EXPECT_EQ(p.options.index(), options.index());
    EXPECT_EQ(p.truth.size(), p.study.gates.size());
    EXPECT_EQ(p.study.modality, "NM");
    EXPECT_EQ(p.study.slice_order, SliceOrder::apex_to_base);
    EXPECT_TRUE(closed_and_oriented(p.truth[0].epi));
    for (const Image& image : p.study.gates) {
      ASSERT_EQ(image.values.size(), image.grid.size());
      for (float v : image.values) ASSERT_TRUE(std::isfinite(v));
    }
  }
}

}  // namespace
}  // namespace dynasurf::synthetic
