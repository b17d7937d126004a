#include <gtest/gtest.h>

#include "dynasurf/ventricle/reconstruct.hpp"

#include "support/blurred_heart.hpp"

namespace dynasurf {
namespace {

Study study_of(const Image& image) {
  Study study;
  study.gates = {image};
  return study;
}

TEST(FindBorders, FindsWhatReconstructFinds) {
  test::HeartShape h;
  h.noise = 0.03;
  const Study study = study_of(test::blurred_heart(h));
  const BorderResult borders = find_borders(study, {});
  const VentricleResult whole = reconstruct(study, {});
  ASSERT_EQ(borders.gates.size(), 1U);
  EXPECT_TRUE(borders.gates[0].labels.has(Wall::endo));
  EXPECT_EQ(borders.gates[0].labels.borders.values, whole.gates[0].labels.borders.values);
  EXPECT_EQ(borders.gates[0].base_slice, whole.gates[0].base_slice);
  EXPECT_EQ(borders.study.gates[0].values, whole.study.gates[0].values);
}

TEST(FindBorders, PreparesTheValuesWhenAsked) {
  const Study study = study_of(test::blurred_heart({}));
  VentricleOptions o;
  o.prepare.doubling = Preparation::Doubling::three;
  const BorderResult borders = find_borders(study, o);
  EXPECT_EQ(borders.study.grid().dims, (Index3{128, 128, 46}));
  EXPECT_TRUE(borders.gates[0].labels.has(Wall::epi));
}

}  // namespace
}  // namespace dynasurf
