#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/psf_fit/blur_fit.hpp"

#include "psf_fit/small_study.hpp"

namespace dynasurf::psf_fit {
namespace {

using test::add_stripes;
using test::biased_start;
using test::known_blur;
using test::small_study;

/// A heart whose walls are far from usual ones, blurred so much that a thick pale wall looks much the same.
synthetic::Phantom unusual_study(double wall_ml) {
  synthetic::VirtualPatient o;
  o.edv_ml = 90, o.ef_percent = 50, o.wall_ml = wall_ml;
  o.gates = 4;
  o.fwhm_mm = 17;
  o.noise.peak_counts = 30;
  o.irregular.papillary_mm = 0;
  o.lattice = {28, 28, 24, 4.8, 4.8, 4.8};
  return synthetic::make_phantom(o);
}

/// Mean distance between two walls, mm, from their apical third to a tenth below the base. The first vertex is the
/// apex.
double thickness_between(const TriMesh& endo, const TriMesh& epi) {
  const Vec3 apex = endo.vertices.front(), length = endo.vertices.back() - apex;
  const mesh::ClosestPoint outer(epi);
  double sum = 0, count = 0;
  for (const Vec3& p : endo.vertices) {
    const double height = (p - apex).dot(length) / length.squaredNorm();
    if (height < 1.0 / 3 || height > 0.9) continue;
    sum += std::sqrt(outer(p).distance2), ++count;
  }
  return sum / count;
}
double thickness_of(const FittedBeat& beat) {
  const FittedGate& gate = beat.gates[static_cast<std::size_t>(beat.ed_gate)];
  return thickness_between(gate.endo, gate.epi);
}

FittedBeat fit_of_given(const Study& study, const FitStart& start, double thickness_mm, double uncertainty) {
  BlurFit options;
  options.thickness_mm = thickness_mm, options.thickness_uncertainty = uncertainty;
  return fit_through_blur(study, start, options);
}

const Note* note_of(const FittedBeat& beat, std::string_view code) {
  const auto found = std::find_if(beat.notes.begin(), beat.notes.end(), [&](const Note& n) { return n.code == code; });
  return found == beat.notes.end() ? nullptr : &*found;
}

TEST(GivenThickness, IsThatBetweenTheReportedSurfaces) {
  synthetic::Phantom phantom = small_study(12);
  add_stripes(phantom.study);
  const FitStart start = biased_start(phantom);
  const double plain_mm = thickness_of(fit_through_blur(phantom.study, start, known_blur(12)));
  for (const double share : {0.85, 1.0, 1.2}) {
    const FittedBeat given = fit_of_given(phantom.study, start, share * plain_mm, 0.01);
    EXPECT_NEAR(thickness_of(given), share * plain_mm, 0.05 * share * plain_mm) << share;
  }
}

TEST(GivenThickness, BringsVolumesOfUnusualWallsNearTheTruth) {
  for (const double wall_ml : {60.0, 160.0}) {
    synthetic::Phantom phantom = unusual_study(wall_ml);
    add_stripes(phantom.study);
    const FitStart start = biased_start(phantom);
    const double truth_ml = phantom.truth.front().endo_ml;
    const double mm = thickness_between(phantom.truth.front().endo, phantom.truth.front().epi);
    const FittedBeat plain = fit_through_blur(phantom.study, start, BlurFit());
    const FittedBeat given = fit_of_given(phantom.study, start, mm, 0.03);
    const double without = plain.edv_ml.value / truth_ml - 1, with = given.edv_ml.value / truth_ml - 1;
    EXPECT_GT(std::abs(without), 0.08) << wall_ml;
    EXPECT_LT(std::abs(with), 0.04) << wall_ml;
    EXPECT_FALSE(note_of(given, "fit.thin_wall")) << "what is believed of hearts plays no part";
    EXPECT_TRUE(note_of(plain, "fit.thin_wall"));
  }
}

TEST(GivenThickness, IsToldAndDoubtedWhereTheImageContradictsIt) {
  const synthetic::Phantom phantom = small_study(12);
  const FitStart start = biased_start(phantom);
  const FittedBeat plain = fit_through_blur(phantom.study, start, known_blur(12));
  const FittedBeat right = fit_of_given(phantom.study, start, thickness_of(plain), 0.1);
  ASSERT_TRUE(note_of(right, "fit.thickness_given"));
  EXPECT_EQ(note_of(right, "fit.thickness_given")->severity, Severity::info);
  const FittedBeat wrong = fit_of_given(phantom.study, start, 3 * thickness_of(plain), 0.1);
  ASSERT_TRUE(note_of(wrong, "fit.thickness_contradicted"));
  EXPECT_EQ(note_of(wrong, "fit.thickness_contradicted")->severity, Severity::warning);
  EXPECT_FALSE(note_of(plain, "fit.thickness_given"));
}

}  // namespace
}  // namespace dynasurf::psf_fit
