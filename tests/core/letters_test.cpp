#include "dynasurf/core/detail/letters.hpp"

#include <gtest/gtest.h>

namespace dynasurf {
namespace {

TEST(Letters, ThatAreNotAsciiStayAsTheyAre) {
  EXPECT_EQ(small_letters("Gated SPECT, 64x64 [Ä] @`{Z"), "gated spect, 64x64 [Ä] @`{z");
}

TEST(Letters, OfSeveralBytesContinueBehindTheFirst) {
  const std::string text = "aä€";  // 1, 2 and 3 bytes
  std::string continued;
  for (const char c : text) continued += continues_character(c) ? 'y' : 'n';
  EXPECT_EQ(continued, "nnynyy");
}

}  // namespace
}  // namespace dynasurf
