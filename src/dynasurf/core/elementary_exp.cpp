#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/elementary_tables.hpp"

namespace dynasurf::own {
namespace {

using namespace detail;

constexpr double infinity = std::numeric_limits<double>::infinity();

double power_of_two(int k) { return std::bit_cast<double>(static_cast<std::uint64_t>(k + 1023) << 52); }

/// x 2^k for x near 1, rounded once.
double scaled(double x, int k) {
  if (k > 1023) return x * 0x1p1023 * power_of_two(k - 1023);
  if (k < -1020) return x * power_of_two(k + 1000) * 0x1p-1000;
  return x * power_of_two(k);
}

/// 2^k of them: what `exp` returns before it is rounded.
struct Exponential {
  Twofold value;
  int k = 0;
};

/// e^(x.high + x.low) for |x| < 746, to 2^-61: with r what x is above the nearest 128th of log 2, 2^(n/128) e^r.
Exponential exponential(Twofold x) {
  // Adding 1.5 * 2^52 rounds to a whole number and leaves it in the lowest bits.
  constexpr double rounder = 0x1.8p52, steps = 0x1.71547652b82fep7;
  const double shifted = x.high * steps + rounder, whole = shifted - rounder;
  const auto n = static_cast<std::int32_t>(std::bit_cast<std::uint64_t>(shifted));
  const Twofold near = sum(x.high - whole * log2_over_128[0], -(whole * log2_over_128[1]));
  const Twofold r = sum(near.high, near.low + (x.low - whole * log2_over_128[2]));
  const double h = r.high, h2 = h * h;
  const double power = h2 * (0.5 + h * (1.0 / 6) + h2 * (1.0 / 24 + h * (1.0 / 120) + h2 * (1.0 / 720)));
  const Twofold& root = powers_of_two[n & 127];
  return {joined(root.high, root.low + root.high * (h + (r.low + power))), n >> 7};
}

/// The logarithm of a finite number above 0, to 2^-67 of itself.
struct Logarithm {
  double whole = 0;  // powers of two
  Twofold rest;      // the logarithm of what is left
};

Logarithm split_logarithm(double x) {
  double shift = 0;
  if (x < std::numeric_limits<double>::min()) x *= 0x1p54, shift = -54;
  constexpr std::uint64_t first = 0x3fe6800000000000;  // 0.703125
  const auto bits = std::bit_cast<std::uint64_t>(x), above = bits - first;
  const auto k = static_cast<std::int32_t>(static_cast<std::int64_t>(above) >> 52);
  const double z = std::bit_cast<double>(bits - (above & 0xfff0000000000000));
  const LogCell& cell = log_cells[(above >> 45) & 127];
  // z times the short inverse, less 1, without loss: |r| < 2^-7.
  const double upper = std::bit_cast<double>(std::bit_cast<std::uint64_t>(z) & 0xffffffff00000000);
  const Twofold r = sum(upper * cell.inverse - 1, (z - upper) * cell.inverse);
  const Twofold r2 = square(r.high);
  const double h = r.high, s = r2.high;
  const double even = 0.25 + s * (1.0 / 6 + s * (1.0 / 8 + s * 0.1));
  const double odd = 1.0 / 3 + s * (1.0 / 5 + s * (1.0 / 7 + s * (1.0 / 9)));
  const Twofold first_two = sum(h, -0.5 * s), all = sum(cell.high, first_two.high);
  const double low =
      all.low + first_two.low + (cell.low + (r.low - h * r.low - 0.5 * r2.low + h * s * (odd - h * even)));
  return {k + shift, joined(all.high, low)};
}

Twofold logarithm(double x) {
  const Logarithm l = split_logarithm(x);
  const Twofold s = sum(l.whole * log2_parts[0], l.rest.high);
  return joined(s.high, s.low + (l.rest.low + l.whole * log2_parts[1]));
}

/// 1/14! to 1/3!.
constexpr double one_over_factorials[12] = {1.0 / 87178291200, 1.0 / 6227020800, 1.0 / 479001600, 1.0 / 39916800,
                                            1.0 / 3628800,     1.0 / 362880,     1.0 / 40320,     1.0 / 5040,
                                            1.0 / 720,         1.0 / 120,        1.0 / 24,        1.0 / 6};

/// What logarithms make of 0, negative numbers, infinity and NaN.
double odd_logarithm(double x) {
  if (x == 0) return -infinity;
  return x < 0 ? std::numeric_limits<double>::quiet_NaN() : x + x;
}
bool is_odd(double x) { return !(x > 0 && x < infinity); }

bool is_whole(double y) { return std::floor(y) == y; }
bool is_odd_whole(double y) { return std::abs(y) < 0x1p53 && is_whole(y) && !is_whole(y / 2); }

/// Powers of 0, infinity and NaN, and to infinity and NaN.
double odd_power(double x, double y) {
  if (std::isnan(x) || std::isnan(y)) return x + y;
  const double size = std::abs(x);
  if (std::isinf(y)) return size == 1 ? 1 : (size > 1) == (y > 0) ? infinity : 0;
  const double power = (size > 1) == (y > 0) ? infinity : 0;
  return is_odd_whole(y) ? std::copysign(power, x) : power;
}

}  // namespace

double exp(double x) {
  if (!(std::abs(x) < 746)) return std::isnan(x) ? x + x : x > 0 ? infinity : 0;
  const Exponential e = exponential({x, 0});
  return scaled(e.value.high + e.value.low, e.k);
}

double expm1(double x) {
  if (std::abs(x) < 0x1p-54) return x;
  if (std::abs(x) < 0.3) {
    const Twofold half = square(x);
    double p = 1.0 / 1307674368000;
    for (int n = 0; n < 12; ++n) p = one_over_factorials[n] + x * p;
    const Twofold s = joined(x, 0.5 * half.high);
    return s.high + (s.low + (0.5 * half.low + x * half.high * p));
  }
  if (!(std::abs(x) < 700)) return x < 0 ? -1 : exp(x);
  const Exponential e = exponential({x, 0});
  if (e.k > 1000) return exp(x);
  if (e.k < -1000) return -1;
  const double scale = power_of_two(e.k);
  const Twofold s = sum(e.value.high * scale, -1);
  return s.high + (s.low + e.value.low * scale);
}

double log(double x) {
  if (is_odd(x)) return odd_logarithm(x);
  const Twofold l = logarithm(x);
  return l.high + l.low;
}

double log2(double x) {
  if (is_odd(x)) return odd_logarithm(x);
  const Logarithm l = split_logarithm(x);
  const Twofold part = l.rest * one_over_log2, s = sum(l.whole, part.high);
  return s.high + (s.low + part.low);
}

double log10(double x) {
  if (is_odd(x)) return odd_logarithm(x);
  const Twofold l = logarithm(x) * one_over_log10;
  return l.high + l.low;
}

double pow(double x, double y) {
  if (y == 0 || x == 1) return 1;
  if (y == 1) return x;
  if (y == 2) return x * x;
  if (x == 0 || !std::isfinite(x) || !std::isfinite(y)) return odd_power(x, y);
  if (x < 0 && !is_whole(y)) return std::numeric_limits<double>::quiet_NaN();
  const double sign = x < 0 && is_odd_whole(y) ? -1 : 1;
  const Twofold l = logarithm(std::abs(x));
  const double rough = y * l.high;
  if (!(std::abs(rough) < 746)) return sign * (rough > 0 ? infinity : 0);
  if (std::abs(rough) < 0x1p-60) return sign * (1 + rough);
  const Twofold p = product(y, l.high);
  const Exponential e = exponential(joined(p.high, p.low + y * l.low));
  return sign * scaled(e.value.high + e.value.low, e.k);
}

double erfc(double x) {
  const double size = std::abs(x);
  if (!(size < 27.5)) return std::isnan(x) ? x + x : x > 0 ? 0 : 2;
  const auto bits = std::bit_cast<std::uint64_t>(size);
  constexpr std::uint64_t first = 0x3fe0000000000000;  // 0.5
  const ErfcCell& cell = erfc_cells[size < 0.5 ? static_cast<std::uint64_t>(size * 8) : 4 + ((bits - first) >> 49)];
  const double s = size - cell.middle;
  double p = 0;
  for (int n = 11; n >= 0; --n) p = cell.terms[n] + s * p;
  const Twofold x2 = square(size);
  const Exponential e = exponential({-x2.high, -x2.low});
  const Twofold value = e.value * joined(cell.value.high, cell.value.low + s * p);
  if (x > 0) return scaled(value.high + value.low, e.k);
  const double scale = e.k < -1000 ? 0 : power_of_two(e.k);
  const Twofold rest = sum(2, -value.high * scale);
  return rest.high + (rest.low - value.low * scale);
}

}  // namespace dynasurf::own
