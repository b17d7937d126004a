#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/twofold.hpp"

namespace dynasurf::own {
namespace {

/// The cube root of a normal number above 0: a guess from the exponent, two of Halley's steps, and Newton's step from a
/// remainder of twice the digits.
double root_of(double a) {
  double x = std::bit_cast<double>(std::bit_cast<std::uint64_t>(a) / 3 + 0x2a9f7625119d328f);
  for (int step = 0; step < 2; ++step) {
    const double cubed = x * x * x;
    x = x * ((cubed + 2 * a) / (2 * cubed + a));
  }
  const Twofold squared = square(x), cubed = product(x, squared.high);
  return x + ((a - cubed.high) - cubed.low - x * squared.low) / (3 * squared.high);
}

/// The root of a sum of squares that are neither very large nor very small.
double length(double x, double y, double z) {
  const Twofold s = square(x) + square(y) + square(z);
  const double q = std::sqrt(s.high);
  const Twofold q2 = square(q);
  return q + ((s.high - q2.high) - q2.low + s.low) / (2 * q);
}

}  // namespace

double cbrt(double x) {
  const double size = std::abs(x);
  if (!(size > 0 && size < std::numeric_limits<double>::infinity())) return x + x;
  // Away from the ends of the range, where cubes and their remainders would leave it.
  if (size < 0x1p-800) return std::copysign(root_of(size * 0x1p300) * 0x1p-100, x);
  if (size > 0x1p800) return std::copysign(root_of(size * 0x1p-300) * 0x1p100, x);
  return std::copysign(root_of(size), x);
}

double hypot(double x, double y, double z) {
  if (std::isinf(x) || std::isinf(y) || std::isinf(z)) return std::numeric_limits<double>::infinity();
  const double a = std::abs(x), b = std::abs(y), c = std::abs(z), most = std::max({a, b, c});
  if (std::isnan(a + b + c)) return a + b + c;
  if (most == 0) return 0;
  if (most > 0x1p400) return length(a * 0x1p-700, b * 0x1p-700, c * 0x1p-700) * 0x1p700;
  if (most < 0x1p-300) return length(a * 0x1p700, b * 0x1p700, c * 0x1p700) * 0x1p-700;
  return length(a, b, c);
}

double hypot(double x, double y) { return hypot(x, y, 0); }

}  // namespace dynasurf::own
