#include "dynasurf/ventricle/detail/canonical.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"

namespace dynasurf::ventricle {
namespace {

/// A cup of bright wall, closed at low k and open at high k, on an oblique grid.
Study cup_study(int gates = 1) {
  Grid grid;
  grid.dims = {24, 24, 12};
  grid.spacing = {3, 3, 6};
  grid.origin = {5, -7, 11};
  grid.direction << 0.6, 0, 0.8, 0, 1, 0, -0.8, 0, 0.6;
  Image image(grid);
  for (int k = 1; k < 11; ++k)
    for (int j = 0; j < 24; ++j)
      for (int i = 0; i < 24; ++i) {
        const double r = std::hypot(i - 12, j - 12);
        if (r <= 8 && (k <= 3 || r >= 5)) image(i, j, k) = 50;
      }
  Study study;
  study.gates.assign(static_cast<std::size_t>(gates), image);
  study.view = View::short_axis;
  study.slice_order = SliceOrder::apex_to_base;
  return study;
}

/// World position of the centre of mass.
Vec3 centre_of_mass(const Image& image) {
  Vec3 sum = Vec3::Zero();
  double mass = 0;
  for (int k = 0; k < image.grid.dims[2]; ++k)
    for (int j = 0; j < image.grid.dims[1]; ++j)
      for (int i = 0; i < image.grid.dims[0]; ++i) {
        sum += image(i, j, k) * to_world(image.grid, centre_of(image.grid, {i, j, k}));
        mass += image(i, j, k);
      }
  return sum / mass;
}

TEST(CanonicalStudy, DividesAllGatesByTheLargestValueOfAllGates) {
  Study study = cup_study(2);
  for (float& v : study.gates[1].values) v *= 0.5F;
  const Study canonical = canonical_study(study);
  EXPECT_EQ(*std::max_element(canonical.gates[0].values.begin(), canonical.gates[0].values.end()), 1.0F);
  EXPECT_EQ(*std::max_element(canonical.gates[1].values.begin(), canonical.gates[1].values.end()), 0.5F);
}

TEST(CanonicalStudy, PutsTheApexFirstAndLeavesEveryVoxelWhereItWasInTheWorld) {
  const Study apex_first = cup_study();
  const Study base_first = reverse_slices(apex_first);
  ASSERT_EQ(base_first.slice_order, SliceOrder::base_to_apex);
  EXPECT_LT((centre_of_mass(base_first.gates[0]) - centre_of_mass(apex_first.gates[0])).norm(), 1e-9);
  const Study canonical = canonical_study(base_first);
  EXPECT_EQ(canonical.slice_order, SliceOrder::apex_to_base);
  EXPECT_EQ(canonical.gates[0].values, canonical_study(apex_first).gates[0].values);
  EXPECT_LT((canonical.grid().origin - apex_first.grid().origin).norm(), 1e-9);
}

TEST(CanonicalStudy, AsksTheDataWhereTheFileDoesNotTellApexFromBase) {
  Study unknown = reverse_slices(cup_study());
  unknown.slice_order = SliceOrder::unknown;
  EXPECT_EQ(guess_slice_order(unknown.gates), SliceOrder::base_to_apex);
  const Study canonical = canonical_study(unknown);
  EXPECT_EQ(canonical.gates[0].values, canonical_study(cup_study()).gates[0].values);
  ASSERT_EQ(canonical.notes.size(), 1U);
  EXPECT_EQ(canonical.notes[0].code, "study.slice_order_guessed");
}

TEST(CanonicalStudy, SaysSoWhenTheDataCannotTellEither) {
  Study flat = cup_study();
  flat.slice_order = SliceOrder::unknown;
  std::fill(flat.gates[0].values.begin(), flat.gates[0].values.end(), 1.0F);
  const Study canonical = canonical_study(flat);
  ASSERT_EQ(canonical.notes.size(), 1U);
  EXPECT_EQ(canonical.notes[0].code, "study.slice_order_unclear");
}

TEST(CanonicalStudy, KeepsAnEmptyStudyAndSaysSo) {
  Study empty = cup_study();
  std::fill(empty.gates[0].values.begin(), empty.gates[0].values.end(), 0.0F);
  const Study canonical = canonical_study(empty);
  ASSERT_EQ(canonical.notes.size(), 1U);
  EXPECT_EQ(canonical.notes[0].code, "study.empty");
  EXPECT_EQ(canonical.notes[0].severity, Severity::failure);
}

TEST(CanonicalStudy, TellsOfAGateThatWasStoredTwice) {
  Study study = cup_study(4);
  for (std::size_t g = 0; g < study.gates.size(); ++g)
    for (float& v : study.gates[g].values) v *= 1 - 0.1F * static_cast<float>(g);
  EXPECT_TRUE(canonical_study(study).notes.empty());
  study.gates[2] = study.gates[1];
  const Notes notes = canonical_study(study).notes;
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].code, "study.same_gates");
  EXPECT_EQ(notes[0].severity, Severity::warning);
  EXPECT_EQ(notes[0].message, "gates 2 and 3 hold the same values: one of them may be lost");
  EXPECT_TRUE(canonical_study(cup_study(4)).notes.empty()) << "nothing moves";
}

TEST(CanonicalStudy, RefusesWhatItCannotWorkOn) {
  Study other_view = cup_study();
  other_view.view = View::horizontal_long_axis;
  EXPECT_THROW(canonical_study(other_view), InputError);

  Study not_finite = cup_study();
  not_finite.gates[0].values[7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(canonical_study(not_finite), InputError);

  Study other_grid = cup_study(2);
  other_grid.gates[1].grid.origin[0] += 1;
  EXPECT_THROW(canonical_study(other_grid), InputError);

  Study thin = cup_study();
  thin.gates[0].grid.dims[2] = 2;
  thin.gates[0].values.resize(thin.gates[0].grid.size());
  EXPECT_THROW(canonical_study(thin), InputError);

  EXPECT_THROW(canonical_study(Study{}), InputError);
}

}  // namespace
}  // namespace dynasurf::ventricle
