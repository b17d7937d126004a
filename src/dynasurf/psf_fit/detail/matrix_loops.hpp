#pragma once
#include <cstddef>
#include <vector>

namespace dynasurf::psf_fit::detail {

// The loops over many numbers that a fit spends its time in, for any instruction set (field/simd.hpp): every copy
// returns the same bytes. Sums are in single precision, over pieces in a fixed order.

/// A matrix whose lines lie together, each filled up with zeros to a multiple of `line_step`.
constexpr std::size_t line_step = 32;
constexpr std::size_t filled_up(std::size_t count) { return (count + line_step - 1) / line_step * line_step; }
struct AlignedMatrix {
  std::size_t count = 0, length = 0;  // of the lines, without what fills them up
  std::vector<float> values;

  AlignedMatrix() = default;
  AlignedMatrix(std::size_t lines, std::size_t long_) : count(lines), length(long_), values(lines * filled_up(long_)) {}
  std::size_t pitch() const { return filled_up(length); }
  float* line(std::size_t n) { return values.data() + n * pitch(); }
  const float* line(std::size_t n) const { return values.data() + n * pitch(); }
};

/// to[i] += factor[n] * from[n][i] for all n < lines, in their order.
void add_lines(float* to, std::size_t length, const float* const* from, const float* factor, std::size_t lines);

/// The same in double precision, from lines `pitch` apart.
void add_lines(double* to, std::size_t length, const double* from, std::size_t pitch, const double* factor,
               std::size_t lines);

/// Lines that `syrk` takes best at a time: they stay in the second cache.
constexpr std::size_t lines_at_once = 128;
/// No sums of squares yet, of lines of this length.
inline AlignedMatrix no_squares(std::size_t length) { return {filled_up(length), length}; }
/// squares[i][j] += sum over the first `count` lines of line[i] * line[j], for j <= i (some beyond).
void syrk(const AlignedMatrix& lines, std::size_t count, AlignedMatrix& squares);

/// to[i][j] -= sum over n < lines of from[n][i] * from[n][j] for i in [begin, end) and j from `first` to i (some
/// beyond); all of them, and `pitch`, by which lines lie apart, multiples of `line_step`.
void syrk_downdate(const double* from, std::size_t lines, std::size_t pitch, std::size_t first, std::size_t begin,
                   std::size_t end, double* to);

/// Replaces the lower triangle of a symmetric positive definite matrix, of at most `corner_size` lines `pitch` apart,
/// by its Cholesky factor.
constexpr std::size_t corner_size = 64;
void factor_corner(double* matrix, std::size_t lines, std::size_t pitch);

/// Replaces lines by those of which the lower triangle `factor` makes them: to[i] becomes (to[i] - sum over n < i of
/// factor[i][n] * to[n]) / factor[i][i].
void solve_lines(const double* factor, std::size_t lines, std::size_t factor_pitch, double* to, std::size_t length,
                 std::size_t pitch);

/// The same for lines of one number.
void solve_numbers(const double* factor, std::size_t lines, std::size_t pitch, double* to);

/// to[g][i] = sum over the first `lines` lines of factor[n * gates + g] * from[n][i], a line of `to` for each gate, for
/// i in [begin, end), multiples of `line_step`.
void gemm(const AlignedMatrix& from, std::size_t lines, const float* factor, std::size_t begin, std::size_t end,
          AlignedMatrix& to);

/// Its transpose: to[n * gates + g] = sum over i in [begin, end) of from[n][i] * fields[g][i].
void gemm_t(const AlignedMatrix& from, std::size_t lines, const AlignedMatrix& fields, std::size_t begin,
            std::size_t end, float* to);

}  // namespace dynasurf::psf_fit::detail
