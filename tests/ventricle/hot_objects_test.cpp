#include "dynasurf/ventricle/detail/hot_objects.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf::ventricle {
namespace {

synthetic::VirtualPatient patient_with_gut(double amplitude) {
  synthetic::VirtualPatient patient;
  patient.gates = 2;
  patient.lattice = {40, 40, 24, 5, 5, 5};
  patient.gut_amplitude = amplitude, patient.gut_gap_mm = 10;
  patient.noise.peak_counts = 300;
  return patient;
}

float peak_of(const Study& study) {
  float peak = 0;
  for (const Image& gate : study.gates)
    peak = std::max(peak, *std::max_element(gate.values.begin(), gate.values.end()));
  return peak;
}

TEST(HotObjects, AreCutToTwiceTheWall) {
  const Study study = synthetic::make_phantom(patient_with_gut(6)).study;
  const auto heart = heart::locate(heart::mean_image(study.gates));
  ASSERT_TRUE(heart);
  const std::optional<Study> cut = cut_hot_objects(study, *heart);
  ASSERT_TRUE(cut);
  EXPECT_LT(peak_of(*cut), 0.6F * peak_of(study));
  EXPECT_EQ(cut->notes.back().code, "study.hot_cut");
  // The wall is left alone: nothing near the middle of the heart is as hot.
  const Grid& grid = study.grid();
  for (std::size_t g = 0; g < study.gates.size(); ++g)
    for (int k = 0; k < grid.dims[2]; ++k)
      for (int j = 0; j < grid.dims[1]; ++j)
        for (int i = 0; i < grid.dims[0]; ++i)
          if ((to_world(grid, centre_of(grid, {i, j, k})) - heart->cup.middle()).norm() < 30) {
            ASSERT_EQ(cut->gates[g](i, j, k), study.gates[g](i, j, k));
          }
}

TEST(HotObjects, AreLookedForOnlyBesideAWall) {
  const Study study = synthetic::make_phantom(patient_with_gut(0)).study;
  heart::Location heart = *heart::locate(heart::mean_image(study.gates));
  EXPECT_FALSE(cut_hot_objects(study, heart)) << "nothing is hotter than the wall";
  const Study hot = synthetic::make_phantom(patient_with_gut(6)).study;
  heart.contrast = 0.1;
  EXPECT_FALSE(cut_hot_objects(hot, heart)) << "a wall that is not clear tells no brightness";
}

}  // namespace
}  // namespace dynasurf::ventricle
