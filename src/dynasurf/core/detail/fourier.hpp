#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/core/grid.hpp"

namespace dynasurf {

/// A complex number of plain arithmetic, without the special cases of std::complex.
struct Complex {
  double re = 0, im = 0;
};

/// Tables of a fast Fourier transform of `size` values, a power of 2.
struct FourierTable {
  int size = 1;
  std::vector<double> cosine, sine;   // of 2 pi k / size
  std::vector<std::uint32_t> turned;  // the bits of a place in the opposite order
};
FourierTable make_fourier_table(int size);
/// The smallest power of 2 that is not below `n`.
int power_of_two(int n);

/// The transform of Cooley and Tukey in place; `sign` -1 forwards, 1 backwards, without a factor.
void transform(const FourierTable& table, std::span<Complex> line, int sign);

/// The same along all axes of a box, first axis fastest; a table per axis.
void transform_box(std::span<const FourierTable, 3> tables, std::span<Complex> box, int sign);
/// The same where only the values of `part` are asked for: the others are of no meaning afterwards.
void transform_box(std::span<const FourierTable, 3> tables, std::span<Complex> box, int sign, const VoxelBox& part);

}  // namespace dynasurf
