#include "dynasurf/psf_fit/detail/camera_errors.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dynasurf::psf_fit {
namespace {

const std::vector<double> edge_ml{60, 30};
constexpr Reconstruction filtered{17, 1, Attenuation::uncorrected, true, false, true};
constexpr Reconstruction recovered{14, 1, Attenuation::corrected, false, false, true};

TEST(CameraErrors, AreNoneOfImagesThatNoCameraHasSeen) {
  for (Reconstruction seen : {filtered, recovered}) {
    seen.misfit = 0;
    const Corrections known = camera_errors(seen, edge_ml), none;
    EXPECT_EQ(known.beyond, 0);
    EXPECT_TRUE(known.edge_ml.empty());
    EXPECT_EQ(known.model_factor, none.model_factor);
    EXPECT_EQ(known.wall_error, none.wall_error);
    seen.misfit = 1, seen.fwhm_mm = 0;
    const Corrections sharp = camera_errors(seen, edge_ml);
    EXPECT_EQ(sharp.beyond, 0);
    EXPECT_EQ(sharp.near_by_contraction, 0);
    EXPECT_TRUE(sharp.edge_ml.empty());
  }
}

TEST(CameraErrors, LeaveTheOuterWallOfOtherModalities) {
  for (Reconstruction seen : {filtered, recovered}) {
    seen.is_spect = false;
    EXPECT_EQ(camera_errors(seen, edge_ml).beyond, 0);
  }
}

TEST(CameraErrors, GrowWithTheMisfit) {
  for (Reconstruction seen : {filtered, recovered}) {
    const Corrections whole = camera_errors(seen, edge_ml);
    seen.misfit = 0.5;
    const Corrections half = camera_errors(seen, edge_ml);
    EXPECT_NEAR(half.beyond, whole.beyond / 2, 1e-12);
    EXPECT_NEAR(half.edges.of_volume, whole.edges.of_volume / 2, 1e-12);
    EXPECT_LT(half.wall_error, whole.wall_error);
  }
}

TEST(CameraErrors, MakeWallsThinnerBehindAFilterAndThickerWhereResolutionWasRecovered) {
  EXPECT_GT(camera_errors(filtered, edge_ml).beyond, 0.05);
  EXPECT_LT(camera_errors(recovered, edge_ml).beyond, -0.05);
  Reconstruction other = recovered;
  other.attenuation = Attenuation::uncorrected;
  EXPECT_EQ(camera_errors(other, edge_ml).beyond, 0);
  double before = camera_errors(recovered, edge_ml).beyond;
  for (other = recovered; other.fwhm_mm < 20; other.fwhm_mm += 0.1) {
    const double beyond = camera_errors(other, edge_ml).beyond;
    EXPECT_LT(std::abs(beyond - before), 0.01) << other.fwhm_mm;
    before = beyond;
  }
  EXPECT_EQ(before, 0);
}

TEST(CameraErrors, LeaveAWallOfGivenThicknessBehindAFilter) {
  Reconstruction given = filtered;
  given.is_thickness_given = true;
  EXPECT_EQ(camera_errors(given, edge_ml).beyond, 0);
  EXPECT_LE(camera_errors(given, edge_ml).edges.of_volume, 0.25);
  given = recovered, given.is_thickness_given = true;
  EXPECT_LT(camera_errors(given, edge_ml).edges.of_volume, camera_errors(recovered, edge_ml).edges.of_volume);
}

}  // namespace
}  // namespace dynasurf::psf_fit
