#include "dynasurf/core/detail/fourier.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace dynasurf {
namespace {

/// A box of numbers that tell its places apart.
std::vector<Complex> some_box(std::size_t size) {
  std::vector<Complex> box(size);
  for (std::size_t n = 0; n < size; ++n)
    box[n] = {std::sin(1.7 * static_cast<double>(n)), std::cos(0.3 * static_cast<double>(n * n))};
  return box;
}

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
  std::vector<Complex> box = some_box(32);
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

TEST(Fourier, ABoxIsTransformedLineByLine) {
  const Index3 size{32, 8, 4};
  const std::array<FourierTable, 3> tables{make_fourier_table(32), make_fourier_table(8), make_fourier_table(4)};
  std::vector<Complex> box = some_box(size_of(size)), expected = box;
  for (std::size_t n = size_of({32, 3, 4}); n < box.size(); ++n) box[n] = expected[n] = {};  // lines of zeros
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t n = 0; n < expected.size(); ++n) {
      Index3 at = voxel_in(size, n);
      if (at[axis] != 0) continue;
      std::vector<Complex> line;
      for (at[axis] = 0; at[axis] < size[axis]; ++at[axis]) line.push_back(expected[index_in(size, at)]);
      transform(tables[axis], line, -1);
      for (at[axis] = 0; at[axis] < size[axis]; ++at[axis])
        expected[index_in(size, at)] = line[static_cast<std::size_t>(at[axis])];
    }
  transform_box(tables, box, -1);
  for (std::size_t n = 0; n < box.size(); ++n) {
    ASSERT_EQ(box[n].re, expected[n].re) << n;
    ASSERT_EQ(box[n].im, expected[n].im) << n;
  }
}

TEST(Fourier, APartOfABoxIsThatOfTheWhole) {
  const std::array<FourierTable, 3> tables{make_fourier_table(16), make_fourier_table(8), make_fourier_table(8)};
  const Index3 size{16, 8, 8};
  const VoxelBox part{{3, 2, 1}, {7, 4, 5}};
  std::vector<Complex> whole = some_box(size_of(size)), box = whole;
  transform_box(tables, whole, 1);
  transform_box(tables, box, 1, part);
  for (int k = 1; k < 6; ++k)
    for (int j = 2; j < 6; ++j)
      for (int i = 3; i < 10; ++i) {
        const std::size_t n = index_in(size, {i, j, k});
        ASSERT_EQ(box[n].re, whole[n].re) << i << ' ' << j << ' ' << k;
        ASSERT_EQ(box[n].im, whole[n].im) << i << ' ' << j << ' ' << k;
      }
}

TEST(Fourier, TakesTheNextPowerOfTwo) {
  EXPECT_EQ(power_of_two(1), 1);
  EXPECT_EQ(power_of_two(33), 64);
  EXPECT_EQ(power_of_two(64), 64);
}

}  // namespace
}  // namespace dynasurf
