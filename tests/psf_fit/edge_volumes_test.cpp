#include "dynasurf/psf_fit/detail/edge_volumes.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace dynasurf::psf_fit {
namespace {

const std::vector<double> fitted{120, 90, 60, 100};  // mL, an ejection fraction of 50 %
constexpr EdgeBelief belief{-0.4, -2, 0.5, 0.25};

/// What edges of an end-diastolic volume (mL) and an ejection fraction (%) show.
std::vector<double> edges_of(double edv_ml, double ef_percent) {
  return {edv_ml, 0.7 * edv_ml, edv_ml * (1 - ef_percent / 100), 0.8 * edv_ml};
}
const double usual_ml = 120 * std::exp(-0.4);

TEST(EdgeVolumes, AsUsualMoveNothing) {
  const std::vector<double> moved = towards_edges(fitted, edges_of(usual_ml, 48), belief);
  for (std::size_t g = 0; g < fitted.size(); ++g) EXPECT_NEAR(moved[g], fitted[g], 1e-9);
}

TEST(EdgeVolumes, MoveAllVolumesByAPartOfTheirRatio) {
  const std::vector<double> moved = towards_edges(fitted, edges_of(1.1 * usual_ml, 48), belief);
  for (std::size_t g = 0; g < fitted.size(); ++g) EXPECT_NEAR(moved[g], std::sqrt(1.1) * fitted[g], 1e-9);
}

TEST(EdgeVolumes, DeepenTheBeatByAPartOfTheEjectionFraction) {
  const std::vector<double> moved = towards_edges(fitted, edges_of(usual_ml, 56), belief);
  EXPECT_NEAR(moved[0], 120, 1e-9);
  EXPECT_NEAR(100 * (1 - moved[2] / moved[0]), 50 + 0.25 * 8, 1e-9);
  EXPECT_NEAR((120 - moved[1]) / (120 - moved[2]), 0.5, 1e-9) << "the course stays";
}

TEST(EdgeVolumes, LedAstrayMoveNoFartherThanALimit) {
  const std::vector<double> moved = towards_edges(fitted, edges_of(20 * usual_ml, 48), belief);
  EXPECT_NEAR(moved[0], 120 * std::exp(0.5 * 0.3), 1e-9);
  const std::vector<double> deeper = towards_edges(std::vector<double>{100, 98}, std::vector<double>{60, 6}, belief);
  EXPECT_GT(deeper[1], 0.97 * deeper[0]);
}

TEST(EdgeVolumes, OfNoBeatMoveNothing) {
  EXPECT_EQ(towards_edges(std::vector<double>{120.0}, std::vector<double>{60.0}, belief), std::vector<double>{120.0});
}

TEST(EdgeVolumes, AreASmallerPartTheWiderThePointSpread) {
  double before = 0;
  for (double fwhm_mm = 8; fwhm_mm < 22; fwhm_mm += 0.25) {
    const double ratio = edge_belief(fwhm_mm, Attenuation::unknown, false).log_ratio;
    EXPECT_LE(ratio, before) << fwhm_mm;
    before = ratio;
  }
}

}  // namespace
}  // namespace dynasurf::psf_fit
