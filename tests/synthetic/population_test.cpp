#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf::synthetic {
namespace {

/// All options as text, so that any difference shows.
std::string text_of(const VirtualPatient& options) {
  std::string text;
  for (const OptionRow& row : option_table(options)) text += row.path + "=" + row.default_value + "\n";
  return text;
}

TEST(Population, DependsOnSeedAndNumberAlone) {
  EXPECT_EQ(text_of(draw_patient(3, 41).options), text_of(draw_patient(3, 41).options));
  EXPECT_NE(text_of(draw_patient(3, 41).options), text_of(draw_patient(3, 42).options));
  EXPECT_NE(text_of(draw_patient(3, 41).options), text_of(draw_patient(4, 41).options));
}

TEST(Population, RepeatsAHeartWithOtherNoiseInAnotherPose) {
  const VirtualPatient a = draw_patient(1, 5, 0).options, b = draw_patient(1, 5, 1).options;
  EXPECT_NE(a.noise.seed, b.noise.seed);
  EXPECT_NE(a.pose.tilt_deg, b.pose.tilt_deg);
  VirtualPatient same = b;
  same.pose = a.pose;
  same.noise = a.noise;
  EXPECT_EQ(text_of(same), text_of(a));
}

TEST(Population, StaysWithinWhatAPhantomCanBe) {
  for (std::uint64_t n = 0; n < 2000; ++n) {
    VirtualPatient patient = draw_patient(9, n).options;
    for (const OptionRow& row : option_table(patient))
      ASSERT_NO_THROW(set_option(patient, row.path + "=" + row.default_value)) << n << " " << row.path;
  }
}

TEST(Population, LooksLikeAClinic) {
  int women = 0, defects = 0, failing = 0;
  std::set<Defect> places;
  constexpr int count = 4000;
  for (std::uint64_t n = 0; n < count; ++n) {
    const DrawnPatient drawn = draw_patient(2, n);
    women += drawn.sex == "F";
    defects += drawn.options.defect != Defect::none;
    failing += drawn.options.ef_percent < 40;
    places.insert(drawn.options.defect);
  }
  // Four standard deviations of a binomial count.
  EXPECT_NEAR(women, 0.45 * count, 4 * std::sqrt(0.45 * 0.55 * count));
  EXPECT_NEAR(defects, 0.4 * count, 4 * std::sqrt(0.4 * 0.6 * count));
  EXPECT_GT(failing, count / 8);
  EXPECT_EQ(places.size(), 6U);
}

TEST(Population, MakesPhantomsWithTheVolumesThatWereDrawn) {
  VirtualPatient options = draw_patient(1, 0).options;
  options.lattice = small_lattice();
  options.gates = 4;
  options.irregular = {};
  const Phantom phantom = make_phantom(options);
  EXPECT_NEAR(*phantom.beat_edv_ml, options.edv_ml, 0.01 * options.edv_ml);
  EXPECT_NEAR(*phantom.beat_ef_percent, options.ef_percent, 0.5);
}

}  // namespace
}  // namespace dynasurf::synthetic
