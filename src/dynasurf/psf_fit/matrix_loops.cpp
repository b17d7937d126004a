#include "dynasurf/psf_fit/detail/matrix_loops.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/lanes.hpp"
#include "dynasurf/core/detail/simd.hpp"

namespace dynasurf::psf_fit::detail {
namespace {

using namespace simd;

// A tile that stays in registers: numbers, and native vectors of numbers.
constexpr std::size_t tall = 4, wide = 2;

/// Factors that `solve_lines` turns the sign of at a time.
constexpr std::size_t most_lines = 64;

/// One vector that the machine has.
template <class T, int native>
using Vector = Pack<T, native, native>;

/// Adds the products of `lines` lines to one tile, or takes them away; `at` begins its first number, `across` its first
/// vector.
template <class V, bool take_away, class T>
DYNASURF_INLINE void add_tile(const T* line, std::size_t pitch, std::size_t lines, std::size_t at, std::size_t across,
                              T* sums) {
  constexpr std::size_t step = V::count;
  V sum[tall][wide];
  for (std::size_t t = 0; t < tall; ++t)
    for (std::size_t w = 0; w < wide; ++w) sum[t][w] = load<V>(sums + t * pitch + w * step);
  for (std::size_t n = 0; n < lines; ++n, line += pitch) {
    const V a = load<V>(line + across), b = load<V>(line + across + step);
    for (std::size_t t = 0; t < tall; ++t) {
      const V factor = line[at + t];
      sum[t][0] = take_away ? sum[t][0] - factor * a : sum[t][0] + factor * a;
      sum[t][1] = take_away ? sum[t][1] - factor * b : sum[t][1] + factor * b;
    }
  }
  for (std::size_t t = 0; t < tall; ++t)
    for (std::size_t w = 0; w < wide; ++w) store(sums + t * pitch + w * step, sum[t][w]);
}

/// One tile of `gemm`: as many gates as `gates` says, 4 at most, two lanes of values.
template <class V, std::size_t gates>
DYNASURF_INLINE void blend_tile(const float* from, std::size_t pitch, std::size_t lines, const float* factor,
                                std::size_t stride, float* to, std::size_t to_pitch) {
  V sum[gates][wide] = {};
  for (std::size_t n = 0; n < lines; ++n, from += pitch, factor += stride) {
    const V a = load<V>(from), b = load<V>(from + lanes);
    for (std::size_t g = 0; g < gates; ++g) {
      sum[g][0] += factor[g] * a;
      sum[g][1] += factor[g] * b;
    }
  }
  for (std::size_t g = 0; g < gates; ++g)
    for (std::size_t w = 0; w < wide; ++w) store(to + g * to_pitch + w * lanes, sum[g][w]);
}

/// Adds the lanes by halves: in this order on every machine, however wide its vectors are.
template <class V>
DYNASURF_INLINE float sum_of(V v) {
  float half[lanes];
  store(half, v);
  for (std::size_t width = lanes / 2; width > 0; width /= 2)
    for (std::size_t l = 0; l < width; ++l) half[l] += half[l + width];
  return half[0];
}

/// One tile of `gemm_t`: two lines, as many gates as `gates` says.
template <class V, std::size_t gates>
DYNASURF_INLINE void project_tile(const float* one, const float* two, const float* fields, std::size_t pitch,
                                  std::size_t begin, std::size_t end, float* to, std::size_t stride) {
  V sum[2][gates] = {};
  for (std::size_t i = begin; i < end; i += lanes) {
    const V a = load<V>(one + i), b = load<V>(two + i);
    for (std::size_t g = 0; g < gates; ++g) {
      const V field = load<V>(fields + g * pitch + i);
      sum[0][g] += a * field;
      sum[1][g] += b * field;
    }
  }
  for (std::size_t g = 0; g < gates; ++g) {
    to[g] = sum_of(sum[0][g]);
    if (one != two) to[stride + g] = sum_of(sum[1][g]);
  }
}

}  // namespace

DYNASURF_CLONES
void add_lines(float* __restrict to, std::size_t length, const float* const* from, const float* factor,
               std::size_t lines) {
  std::size_t n = 0;
  // Four lines in one pass over the sums, in one expression, which keeps the order of the lines.
  for (; n + 4 <= lines; n += 4) {
    const float *a = from[n], *b = from[n + 1], *c = from[n + 2], *d = from[n + 3];
    const float fa = factor[n], fb = factor[n + 1], fc = factor[n + 2], fd = factor[n + 3];
    for (std::size_t i = 0; i < length; ++i) to[i] = to[i] + fa * a[i] + fb * b[i] + fc * c[i] + fd * d[i];
  }
  for (; n < lines; ++n)
    for (std::size_t i = 0; i < length; ++i) to[i] += factor[n] * from[n][i];
}

DYNASURF_CLONES
void add_lines(double* __restrict to, std::size_t length, const double* from, std::size_t pitch, const double* factor,
               std::size_t lines) {
  std::size_t n = 0;
  for (; n + 4 <= lines; n += 4, from += 4 * pitch) {
    const double *a = from, *b = a + pitch, *c = b + pitch, *d = c + pitch;
    const double fa = factor[n], fb = factor[n + 1], fc = factor[n + 2], fd = factor[n + 3];
    for (std::size_t i = 0; i < length; ++i) to[i] = to[i] + fa * a[i] + fb * b[i] + fc * c[i] + fd * d[i];
  }
  for (; n < lines; ++n, from += pitch)
    for (std::size_t i = 0; i < length; ++i) to[i] += factor[n] * from[i];
}

DYNASURF_CLONES
void factor_corner(double* matrix, std::size_t lines, std::size_t pitch) {
  double column[corner_size];
  for (std::size_t j = 0; j < lines; ++j) {
    const double square = matrix[j * pitch + j];
    const double pivot = square > 0 ? std::sqrt(square) : 1;
    matrix[j * pitch + j] = pivot;
    for (std::size_t i = j + 1; i < lines; ++i) column[i] = matrix[i * pitch + j] /= pivot;
    for (std::size_t i = j + 1; i < lines; ++i) {
      double* const line = matrix + i * pitch;
      const double factor = column[i];
      for (std::size_t k = j + 1; k <= i; ++k) line[k] -= factor * column[k];
    }
  }
}

void solve_lines(const double* factor, std::size_t lines, std::size_t factor_pitch, double* to, std::size_t length,
                 std::size_t pitch) {
  double less[most_lines];
  for (std::size_t i = 0; i < lines; ++i) {
    const double* const row = factor + i * factor_pitch;
    double* const line = to + i * pitch;
    for (std::size_t begin = 0; begin < i; begin += most_lines) {
      const std::size_t count = std::min(most_lines, i - begin);
      for (std::size_t n = 0; n < count; ++n) less[n] = -row[begin + n];
      add_lines(line, length, to + begin * pitch, pitch, less, count);
    }
    for (std::size_t c = 0; c < length; ++c) line[c] /= row[i];
  }
}

void solve_numbers(const double* factor, std::size_t lines, std::size_t pitch, double* to) {
  for (std::size_t i = 0; i < lines; i += tall) {
    const std::size_t rows = std::min(tall, lines - i);
    const double* row[tall];
    double sum[tall] = {};
    // Behind the last line it stands in again, so that the inner loop has no branch; those sums go nowhere.
    for (std::size_t t = 0; t < tall; ++t) row[t] = factor + (i + std::min(t, rows - 1)) * pitch;
    for (std::size_t t = 0; t < rows; ++t) sum[t] = to[i + t];
    for (std::size_t n = 0; n < i; ++n)
      for (std::size_t t = 0; t < tall; ++t) sum[t] -= row[t][n] * to[n];
    for (std::size_t t = 0; t < rows; ++t) {
      for (std::size_t n = i; n < i + t; ++n) sum[t] -= row[t][n] * to[n];
      to[i + t] = sum[t] / row[t][i + t];
    }
  }
}

void syrk(const AlignedMatrix& lines, std::size_t count, AlignedMatrix& squares) {
  const std::size_t pitch = lines.pitch();
  field::detail::with_native_vectors([&]<int native>() DYNASURF_INLINE_LAMBDA {
    for (std::size_t n = 0; n < count; n += lines_at_once)
      for (std::size_t across = 0; across < pitch; across += wide * native)
        for (std::size_t at = across; at < pitch; at += tall)
          add_tile<Vector<float, native>, false>(lines.line(n), pitch, std::min(lines_at_once, count - n), at, across,
                                                 squares.values.data() + at * pitch + across);
  });
}

void syrk_downdate(const double* from, std::size_t lines, std::size_t pitch, std::size_t first, std::size_t begin,
                   std::size_t end, double* to) {
  field::detail::with_native_vectors([&]<int native>() DYNASURF_INLINE_LAMBDA {
    for (std::size_t across = first; across < end; across += wide * native / 2)
      for (std::size_t at = std::max(begin, across); at < end; at += tall)
        add_tile<Vector<double, native / 2>, true>(from, pitch, lines, at, across, to + at * pitch + across);
  });
}

void gemm(const AlignedMatrix& from, std::size_t lines, const float* factor, std::size_t begin, std::size_t end,
          AlignedMatrix& to) {
  const std::size_t gates = to.count, pitch = from.pitch();
  field::detail::with_native_vectors([&]<int native>() DYNASURF_INLINE_LAMBDA {
    using V = Floats<native>;
    for (std::size_t i = begin; i < end; i += wide * simd::lanes) {
      const float* at = from.values.data() + i;
      float* sums = to.values.data() + i;
      std::size_t g = 0;
      for (; g + 4 <= gates; g += 4) blend_tile<V, 4>(at, pitch, lines, factor + g, gates, sums + g * pitch, pitch);
      for (; g < gates; ++g) blend_tile<V, 1>(at, pitch, lines, factor + g, gates, sums + g * pitch, pitch);
    }
  });
}

void gemm_t(const AlignedMatrix& from, std::size_t lines, const AlignedMatrix& fields, std::size_t begin,
            std::size_t end, float* to) {
  const std::size_t gates = fields.count, pitch = from.pitch();
  field::detail::with_native_vectors([&]<int native>() DYNASURF_INLINE_LAMBDA {
    using V = Floats<native>;
    for (std::size_t n = 0; n < lines; n += 2) {
      const float* one = from.values.data() + n * pitch;
      // An odd last line stands in both places, and its second sum is not stored.
      const float* two = n + 1 < lines ? one + pitch : one;
      const float* values = fields.values.data();
      float* sums = to + n * gates;
      std::size_t g = 0;
      for (; g + 4 <= gates; g += 4)
        project_tile<V, 4>(one, two, values + g * pitch, pitch, begin, end, sums + g, gates);
      for (; g < gates; ++g) project_tile<V, 1>(one, two, values + g * pitch, pitch, begin, end, sums + g, gates);
    }
  });
}

}  // namespace dynasurf::psf_fit::detail
