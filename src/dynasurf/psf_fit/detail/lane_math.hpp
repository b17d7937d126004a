#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>

#include "dynasurf/core/detail/simd.hpp"

namespace dynasurf::psf_fit::detail {

// Functions of one float without branches or calls, so that loops over them are done many values at a time. Relative
// errors stay below 3e-7.

/// e^x; x is held within [-87, 88].
DYNASURF_INLINE float exp_of(float x) {
  x = std::min(std::max(x, -87.0F), 88.0F);
  // Adding 1.5 * 2^23 rounds to a whole number and leaves it in the lowest bits.
  constexpr float rounder = 12582912.0F;
  const float shifted = x * 1.44269504F + rounder;
  const float whole = shifted - rounder;
  const float r = (x - whole * 0.693359375F) + whole * 2.12194440e-4F;  // less whole * log 2, in two parts
  float p = 1.9875691500e-4F;
  p = p * r + 1.3981999507e-3F;
  p = p * r + 8.3334519073e-3F;
  p = p * r + 4.1665795894e-2F;
  p = p * r + 1.6666665459e-1F;
  p = p * r + 5.0000001201e-1F;
  const std::uint32_t power = (std::bit_cast<std::uint32_t>(shifted) + 127U) << 23U;
  return (p * r * r + r + 1) * std::bit_cast<float>(power);
}

/// The cube root of a number from 1e-28 to 1e28: a guess from its exponent, then two of Halley's steps.
DYNASURF_INLINE float cube_root(float a) {
  const std::int32_t third = std::bit_cast<std::int32_t>(a) * (1.0F / 3);
  float x = std::bit_cast<float>(third + 0x2a514067);
  for (int step = 0; step < 2; ++step) {
    const float cubed = x * x * x;
    x = x * (cubed + 2 * a) / (2 * cubed + a);
  }
  return x;
}

/// A Gaussian step of width 1 at s, and its slope; over at 4.5 widths on either side.
struct Step {
  float share = 0, slope = 0;
};
DYNASURF_INLINE Step normal_cdf(float s) {
  constexpr float beyond = 4.5F, peak = 0.39894228F;
  const float t = std::min(s < 0 ? -s : s, beyond);
  const float slope = peak * exp_of(-0.5F * t * t);
  // What lies beyond t, over the slope (Mills's ratio), as a polynomial in (t - 3) / (t + 3).
  const float v = (t - 3) / (t + 3);
  float ratio = -0.000907760377F;
  ratio = ratio * v - 0.00219405826F;
  ratio = ratio * v + 0.00749904385F;
  ratio = ratio * v + 0.0154064045F;
  ratio = ratio * v - 0.115851539F;
  ratio = ratio * v + 0.308876799F;
  ratio = ratio * v - 0.517374451F;
  ratio = ratio * v + 0.304590314F;
  const float rest = t < beyond ? slope * ratio : 0;
  return {s < 0 ? rest : 1 - rest, t < beyond ? slope : 0};
}

}  // namespace dynasurf::psf_fit::detail
