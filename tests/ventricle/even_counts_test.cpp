#include "dynasurf/ventricle/detail/even_counts.hpp"

#include <numeric>

#include <gtest/gtest.h>

#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf::ventricle {
namespace {

Study beating(int gates = 8) {
  synthetic::VirtualPatient patient;
  patient.gates = gates;
  patient.lattice = {40, 40, 24, 5, 5, 5};
  patient.background = 0.15;
  return synthetic::make_phantom(patient).study;
}

heart::Location heart_of(const Study& study) { return *heart::locate(heart::mean_image(study.gates)); }

void dim(Image& gate, float share) {
  for (float& v : gate.values) v *= share;
}

double counts_of(const Image& gate) { return std::accumulate(gate.values.begin(), gate.values.end(), 0.0); }

TEST(EvenCounts, BringAGateToTheOthers) {
  const Study whole = beating();
  const heart::Location heart = heart_of(whole);
  EXPECT_FALSE(with_even_counts(whole, heart)) << "a beating heart keeps its counts";
  for (const float share : {0.5F, 0.9F, 1.5F}) {
    Study study = whole;
    dim(study.gates.back(), share);
    const std::optional<Study> even = with_even_counts(study, heart);
    ASSERT_TRUE(even) << share;
    EXPECT_NEAR(counts_of(even->gates.back()) / counts_of(whole.gates.back()), 1, 0.02);
    for (std::size_t g = 0; g + 1 < whole.gates.size(); ++g) EXPECT_EQ(even->gates[g].values, whole.gates[g].values);
    ASSERT_FALSE(even->notes.empty());
    EXPECT_EQ(even->notes.back().code, "study.counts_scaled");
    EXPECT_EQ(even->notes.back().gate, 7);
    EXPECT_EQ(even->notes.back().severity, share == 0.9F ? Severity::info : Severity::warning);
  }
}

TEST(EvenCounts, AreLeftAloneWhereTheHeartAloneIsDim) {
  Study study = beating();
  const heart::Location heart = heart_of(study);
  const heart::LvShell cup = to_grid(study.grid(), heart.cup);
  Image& gate = study.gates.back();
  for (int k = 0; k < gate.grid.dims[2]; ++k)
    for (int j = 0; j < gate.grid.dims[1]; ++j)
      for (int i = 0; i < gate.grid.dims[0]; ++i)
        if (heart::signed_distance(cup, centre_of(gate.grid, {i, j, k})) < 12) gate(i, j, k) *= 0.5F;
  EXPECT_FALSE(with_even_counts(study, heart));
}

TEST(EvenCounts, AreOfImagesThatHoldCounts) {
  Study study = beating();
  const heart::Location heart = heart_of(study);
  dim(study.gates.back(), 0.5F);
  study.modality = "MR";
  EXPECT_FALSE(with_even_counts(study, heart));
  study.modality = "PT";
  EXPECT_TRUE(with_even_counts(study, heart));
  dim(study.gates.back(), 0.4F);
  EXPECT_FALSE(with_even_counts(study, heart)) << "a fifth: that gate is lost";
  study.gates.resize(3);
  EXPECT_FALSE(with_even_counts(study, heart));
}

}  // namespace
}  // namespace dynasurf::ventricle
