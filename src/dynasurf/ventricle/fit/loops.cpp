#include "dynasurf/ventricle/fit/loops.hpp"

#include <algorithm>

#include "dynasurf/field/simd.hpp"

namespace dynasurf::detail {
namespace {

typedef float Lanes __attribute__((vector_size(64)));
typedef float LooseLanes __attribute__((vector_size(64), aligned(4), may_alias));
typedef double DoubleLanes __attribute__((vector_size(64)));
typedef double LooseDoubleLanes __attribute__((vector_size(64), aligned(8), may_alias));

constexpr std::size_t lane_count = 16;
constexpr std::size_t tall = 4, wide = 2;  // a tile that stays in registers: numbers, and lanes of numbers

/// Adds the products of `lines` lines to one tile; `at` begins its first number, `across` its first lane.
DYNASURF_INLINE void add_tile(const float* line, std::size_t pitch, std::size_t lines, std::size_t at,
                              std::size_t across, float* sums) {
  Lanes sum[tall][wide];
  for (std::size_t t = 0; t < tall; ++t)
    for (std::size_t w = 0; w < wide; ++w)
      sum[t][w] = *reinterpret_cast<const LooseLanes*>(sums + t * pitch + w * lane_count);
  for (std::size_t n = 0; n < lines; ++n, line += pitch) {
    const Lanes a = *reinterpret_cast<const LooseLanes*>(line + across),
                b = *reinterpret_cast<const LooseLanes*>(line + across + lane_count);
    for (std::size_t t = 0; t < tall; ++t) {
      const float factor = line[at + t];
      sum[t][0] += factor * a;
      sum[t][1] += factor * b;
    }
  }
  for (std::size_t t = 0; t < tall; ++t)
    for (std::size_t w = 0; w < wide; ++w)
      *reinterpret_cast<LooseLanes*>(sums + t * pitch + w * lane_count) = sum[t][w];
}

/// The same in double precision, taken away.
DYNASURF_INLINE void subtract_tile(const double* line, std::size_t pitch, std::size_t lines, std::size_t at,
                                   std::size_t across, double* sums) {
  constexpr std::size_t lanes = 8;
  DoubleLanes sum[tall][wide];
  for (std::size_t t = 0; t < tall; ++t)
    for (std::size_t w = 0; w < wide; ++w)
      sum[t][w] = *reinterpret_cast<const LooseDoubleLanes*>(sums + t * pitch + w * lanes);
  for (std::size_t n = 0; n < lines; ++n, line += pitch) {
    const DoubleLanes a = *reinterpret_cast<const LooseDoubleLanes*>(line + across),
                      b = *reinterpret_cast<const LooseDoubleLanes*>(line + across + lanes);
    for (std::size_t t = 0; t < tall; ++t) {
      const double factor = line[at + t];
      sum[t][0] -= factor * a;
      sum[t][1] -= factor * b;
    }
  }
  for (std::size_t t = 0; t < tall; ++t)
    for (std::size_t w = 0; w < wide; ++w)
      *reinterpret_cast<LooseDoubleLanes*>(sums + t * pitch + w * lanes) = sum[t][w];
}

DYNASURF_CLONES
void add_squares_of_some(const float* lines, std::size_t count, std::size_t pitch, float* sums) {
  for (std::size_t across = 0; across < pitch; across += wide * lane_count)
    for (std::size_t at = across; at < pitch; at += tall)
      add_tile(lines, pitch, count, at, across, sums + at * pitch + across);
}

/// One tile of `blend`: as many gates as `gates` says, 4 at most, two lanes of values.
template <std::size_t gates>
DYNASURF_INLINE void blend_tile(const float* from, std::size_t pitch, std::size_t lines, const float* factor,
                                std::size_t stride, float* to, std::size_t to_pitch) {
  Lanes sum[gates][wide] = {};
  for (std::size_t n = 0; n < lines; ++n, from += pitch, factor += stride) {
    const Lanes a = *reinterpret_cast<const LooseLanes*>(from),
                b = *reinterpret_cast<const LooseLanes*>(from + lane_count);
    for (std::size_t g = 0; g < gates; ++g) {
      sum[g][0] += factor[g] * a;
      sum[g][1] += factor[g] * b;
    }
  }
  for (std::size_t g = 0; g < gates; ++g)
    for (std::size_t w = 0; w < wide; ++w)
      *reinterpret_cast<LooseLanes*>(to + g * to_pitch + w * lane_count) = sum[g][w];
}

DYNASURF_INLINE float sum_of(const Lanes& lanes) {
  float half[lane_count];
  for (std::size_t l = 0; l < lane_count; ++l) half[l] = lanes[l];
  for (std::size_t width = lane_count / 2; width > 0; width /= 2)
    for (std::size_t l = 0; l < width; ++l) half[l] += half[l + width];
  return half[0];
}

/// One tile of `project`: two lines, as many gates as `gates` says.
template <std::size_t gates>
DYNASURF_INLINE void project_tile(const float* one, const float* two, const float* fields, std::size_t pitch,
                                  std::size_t begin, std::size_t end, float* to, std::size_t stride) {
  Lanes sum[2][gates] = {};
  for (std::size_t i = begin; i < end; i += lane_count) {
    const Lanes a = *reinterpret_cast<const LooseLanes*>(one + i), b = *reinterpret_cast<const LooseLanes*>(two + i);
    for (std::size_t g = 0; g < gates; ++g) {
      const Lanes field = *reinterpret_cast<const LooseLanes*>(fields + g * pitch + i);
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
void add_lines(float* to, std::size_t length, const float* const* from, const float* factor, std::size_t lines) {
  std::size_t n = 0;
  for (; n + 4 <= lines; n += 4) {
    const float *a = from[n], *b = from[n + 1], *c = from[n + 2], *d = from[n + 3];
    const float fa = factor[n], fb = factor[n + 1], fc = factor[n + 2], fd = factor[n + 3];
    for (std::size_t i = 0; i < length; ++i) to[i] = to[i] + fa * a[i] + fb * b[i] + fc * c[i] + fd * d[i];
  }
  for (; n < lines; ++n)
    for (std::size_t i = 0; i < length; ++i) to[i] += factor[n] * from[n][i];
}

void add_squares(const Lines& lines, std::size_t count, Lines& squares) {
  for (std::size_t n = 0; n < count; n += lines_at_once)
    add_squares_of_some(lines.line(n), std::min(lines_at_once, count - n), lines.pitch(), squares.values.data());
}

DYNASURF_CLONES
void subtract_squares(const double* from, std::size_t lines, std::size_t pitch, std::size_t first, std::size_t begin,
                      std::size_t end, double* to) {
  constexpr std::size_t across_at_once = 16;
  for (std::size_t across = first; across < end; across += across_at_once)
    for (std::size_t at = std::max(begin, across); at < end; at += tall)
      subtract_tile(from, pitch, lines, at, across, to + at * pitch + across);
}

DYNASURF_CLONES
void blend(const Lines& from, std::size_t lines, const float* factor, std::size_t begin, std::size_t end, Lines& to) {
  const std::size_t gates = to.count, pitch = from.pitch();
  for (std::size_t i = begin; i < end; i += wide * lane_count) {
    const float* at = from.values.data() + i;
    std::size_t g = 0;
    for (; g + 4 <= gates; g += 4)
      blend_tile<4>(at, pitch, lines, factor + g, gates, to.values.data() + g * pitch + i, pitch);
    for (; g < gates; ++g) blend_tile<1>(at, pitch, lines, factor + g, gates, to.values.data() + g * pitch + i, pitch);
  }
}

DYNASURF_CLONES
void project(const Lines& from, std::size_t lines, const Lines& fields, std::size_t begin, std::size_t end, float* to) {
  const std::size_t gates = fields.count, pitch = from.pitch();
  for (std::size_t n = 0; n < lines; n += 2) {
    const float* one = from.values.data() + n * pitch;
    const float* two = n + 1 < lines ? one + pitch : one;
    std::size_t g = 0;
    for (; g + 4 <= gates; g += 4)
      project_tile<4>(one, two, fields.values.data() + g * pitch, pitch, begin, end, to + n * gates + g, gates);
    for (; g < gates; ++g)
      project_tile<1>(one, two, fields.values.data() + g * pitch, pitch, begin, end, to + n * gates + g, gates);
  }
}

}  // namespace dynasurf::detail
