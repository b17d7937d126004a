#include "dynasurf/core/detail/fourier.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace dynasurf {
namespace {

TEST(Fourier, AWaveIsOneFrequency) {
  const FourierTable table = make_fourier_table(16);
  std::vector<Complex> line(16);
  for (int n = 0; n < 16; ++n)
    line[static_cast<std::size_t>(n)] = {std::cos(2 * M_PI * 3 * n / 16), std::sin(2 * M_PI * 3 * n / 16)};
  transform(table, line, -1);
  for (std::size_t k = 0; k < 16; ++k) {
    EXPECT_NEAR(line[k].re, k == 3 ? 16 : 0, 1e-12);
    EXPECT_NEAR(line[k].im, 0, 1e-12);
  }
}

TEST(Fourier, ABoxComesBack) {
  const std::array<FourierTable, 3> tables{make_fourier_table(8), make_fourier_table(1), make_fourier_table(4)};
  std::vector<Complex> box(32);
  for (std::size_t n = 0; n < 32; ++n)
    box[n] = {std::sin(1.7 * static_cast<double>(n)), std::cos(0.3 * static_cast<double>(n * n))};
  const std::vector<Complex> before = box;
  transform_box(tables, box, -1);
  double power = 0, power_before = 0;
  for (std::size_t n = 0; n < 32; ++n) {
    power += box[n].re * box[n].re + box[n].im * box[n].im;
    power_before += before[n].re * before[n].re + before[n].im * before[n].im;
  }
  EXPECT_NEAR(power, 32 * power_before, 1e-9);  // Parseval
  transform_box(tables, box, 1);
  for (std::size_t n = 0; n < 32; ++n) {
    EXPECT_NEAR(box[n].re, 32 * before[n].re, 1e-12 * 32 * 32);
    EXPECT_NEAR(box[n].im, 32 * before[n].im, 1e-12 * 32 * 32);
  }
}

TEST(Fourier, TakesTheNextPowerOfTwo) {
  EXPECT_EQ(power_of_two(1), 1);
  EXPECT_EQ(power_of_two(33), 64);
  EXPECT_EQ(power_of_two(64), 64);
}

}  // namespace
}  // namespace dynasurf
