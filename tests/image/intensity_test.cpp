#include "dynasurf/image/intensity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"

namespace dynasurf {
namespace {

Image line(std::vector<float> values) {
  Image m;
  m.grid.dims = {static_cast<int>(values.size()), 1, 1};
  m.values = std::move(values);
  return m;
}

TEST(Normalise, MakesTheMaximumExactlyOne) {
  Notes notes;
  const Image once = normalise(line({3, -1, 7, 0.1F}), notes);
  EXPECT_EQ(once.values[2], 1.0F);
  EXPECT_FLOAT_EQ(once.values[1], -1.0F / 7);
  EXPECT_EQ(normalise(once, notes).values, once.values);  // idempotent
  EXPECT_TRUE(notes.empty());
}

TEST(Normalise, LeavesAVolumeWithoutPositiveValuesAndSaysSo) {
  for (const auto& values : {std::vector<float>{0, 0}, std::vector<float>{-2, -1}, std::vector<float>{}}) {
    Notes notes;
    EXPECT_EQ(normalise(line(values), notes).values, values);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_EQ(notes[0].code, "normalise.empty");
  }
}

TEST(SuppressNoise, ZeroesWhatLiesBelowAShareOfTheMaximum) {
  EXPECT_THAT(suppress_noise(line({10, 1.9F, 2, -3}), 0.2).values, testing::ElementsAre(10, 0, 2, 0));
  EXPECT_THAT(suppress_noise(line({10, -3}), 0).values, testing::ElementsAre(10, -3));
  EXPECT_THROW(suppress_noise(line({1}), 1.5), OptionError);
}

}  // namespace
}  // namespace dynasurf
