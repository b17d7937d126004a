#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/elementary_tables.hpp"

namespace dynasurf::own {
namespace {

using namespace detail;

/// An angle as quarter turns (of which only the last two bits matter) and a rest of pi/4 at most.
struct Reduced {
  Twofold rest;
  unsigned quarters = 0;
};

Reduced reduced_near(double x) {
  constexpr double rounder = 0x1.8p52, two_over_pi_high = 0x1.45f306dc9c883p-1;
  const double shifted = x * two_over_pi_high + rounder, n = shifted - rounder;
  const Twofold a = sum(x - n * half_pi_parts[0], -(n * half_pi_parts[1])), b = sum(a.high, -(n * half_pi_parts[2]));
  const Twofold rest = sum(b.high, a.low + (b.low - n * half_pi_parts[3]));
  return {rest, static_cast<unsigned>(std::bit_cast<std::uint64_t>(shifted) & 3)};
}

/// Words of 32 bits, the lowest first: nine of a product, and a zero above them. Below 2^21 the point stands before the
/// ninth, and the words on both of its sides are looked at.
using Words = std::array<std::uint64_t, 10>;

/// `whole` times the 7 words of 2/pi from `first` on.
Words times_two_over_pi(std::uint64_t whole, int first) {
  Words out{};
  const std::uint64_t factors[2] = {whole & 0xffffffff, whole >> 32};
  for (std::size_t f = 0; f < 2; ++f) {
    std::uint64_t carry = 0;
    for (std::size_t w = 0; w < 7; ++w) {
      const std::uint64_t p = factors[f] * two_over_pi[static_cast<std::size_t>(first) + 6 - w] + out[f + w] + carry;
      out[f + w] = p & 0xffffffff;
      carry = p >> 32;
    }
    out[f + 7] = carry;
  }
  return out;
}

/// For x >= 2^20, without loss (after Payne and Hanek): words of 2/pi that make whole turns alone are left out, and so
/// are those that come after 190 bits behind the point.
Reduced reduced_far(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  const std::uint64_t whole = (bits & 0xfffffffffffff) | 0x10000000000000;
  const int exponent = static_cast<int>(bits >> 52) - 1075;  // x = whole 2^exponent
  const int first = std::max(0, (exponent - 2) >> 5);        // counted from 0
  Words p = times_two_over_pi(whole, first);
  const int point = 32 * (first + 7) - exponent, word = point / 32, bit = point % 32;
  const auto at = static_cast<std::size_t>(word);
  auto quarters = static_cast<unsigned>(((p[at + 1] << 32 | p[at]) >> bit) & 3);
  for (std::size_t w = at; w < p.size(); ++w) p[w] &= w == at ? (std::uint64_t{1} << bit) - 1 : 0;
  const int top = point - 1;
  const bool above_half = (p[top / 32] >> (top % 32)) & 1;
  if (above_half) {  // one less the fraction
    std::uint64_t carry = 1;
    for (std::size_t w = 0; w <= at; ++w) {
      const std::uint64_t mask = w == at ? (std::uint64_t{1} << bit) - 1 : 0xffffffff;
      const std::uint64_t v = (~p[w] & mask) + carry;
      p[w] = v & mask;
      carry = v >> 32;
    }
    ++quarters;
  }
  Twofold fraction;
  for (std::size_t w = 0; w <= at; ++w) {
    const Twofold s = sum(std::ldexp(static_cast<double>(p[w]), 32 * static_cast<int>(w) - point), fraction.high);
    fraction = joined(s.high, s.low + fraction.low);
  }
  if (above_half) fraction = {-fraction.high, -fraction.low};
  return {fraction * half_pi, quarters};
}

Reduced reduced(double x) {
  if (std::abs(x) <= 0.785) return {{x, 0}, 0};
  if (std::abs(x) < 0x1p20) return reduced_near(x);
  Reduced r = reduced_far(std::abs(x));
  if (x < 0) r = {{-r.rest.high, -r.rest.low}, 4 - r.quarters};
  return r;
}

template <std::size_t count>
double polynomial(const double (&terms)[count], double t) {
  double p = terms[count - 1];
  for (std::size_t n = count - 1; n > 0;) {
    --n;
    p = terms[n] + t * p;
  }
  return p;
}

/// The sine of |r| <= pi/4, not yet rounded.
Twofold sine_near(Twofold r) {
  const double t = r.high * r.high;
  return joined(r.high, r.high * t * polynomial(sine_terms, t) + r.low * (1 - 0.5 * t));
}

Twofold cosine_near(Twofold r) {
  const Twofold t = square(r.high);
  const Twofold s = joined(1, -0.5 * t.high);
  const double rest = t.high * t.high * polynomial(cosine_terms, t.high) - r.high * r.low - 0.5 * t.low;
  return joined(s.high, s.low + rest);
}

Twofold sine_of(Reduced r) {
  const Twofold s = r.quarters & 1 ? cosine_near(r.rest) : sine_near(r.rest);
  return r.quarters & 2 ? Twofold{-s.high, -s.low} : s;
}

/// The angle in [0, pi/4] whose tangent is b/a, for 0 <= b <= a, neither far from 1: the arc tangent of the nearest
/// 32nd, and of what is left. Three numbers whose sum it is.
struct Angle {
  Twofold table;
  double high = 0, low = 0;
};

Angle angle_of(Twofold b, Twofold a) {
  const double n = std::floor(32 * (b.high / a.high) + 0.5), c = n / 32;
  const Twofold x = halves(a.high), y = halves(b.high);
  const Twofold down = sum(b.high, -(c * x.high)), more = sum(down.high, -(c * x.low));
  const Twofold up = sum(a.high, c * y.high), further = sum(up.high, c * y.low);
  const Twofold above = joined(more.high, more.low + down.low + (b.low - c * a.low));
  const Twofold u = above / joined(further.high, further.low + up.low + (a.low + c * b.low));
  const double t = u.high * u.high;
  const double power = 1.0 / 3 - t * (1.0 / 5 - t * (1.0 / 7 - t * (1.0 / 9 - t * (1.0 / 11))));
  return {arc_tangents[static_cast<int>(n)], u.high, u.low - u.high * t * power};
}

/// Quarter turns plus or minus an angle.
double turned(double quarters, double sign, const Angle& angle) {
  const Twofold base = sum(quarters * half_pi.high, sign * angle.table.high), s = sum(base.high, sign * angle.high);
  return s.high + (s.low + (base.low + (quarters * half_pi.low + sign * (angle.table.low + angle.low))));
}

/// The angle of (x, y), in [0, pi], for y >= 0; `left` says that x stands for -x.
double angle_at(Twofold y, Twofold x, bool left) {
  if (y.high > x.high) return turned(1, left ? 1 : -1, angle_of(x, y));
  return turned(left ? 2 : 0, left ? -1 : 1, angle_of(y, x));
}

/// The same where one is far larger than the other, or either is 0 or infinite.
double odd_angle(double y, double x, bool left) {
  constexpr double tiny = 0x1p-1000;  // makes the sum inexact, nothing more
  if (std::isinf(x) && std::isinf(y)) return (left ? 3 : 1) * (half_pi.high / 2) + (left ? 0x1.a79394c9e8a0ap-54 : 0);
  if (y > x) return half_pi.high + (left ? 1 : -1) * (y < 0x1p500 * x ? x / y : tiny);
  if (left) return 2 * half_pi.high - (y == 0 ? 0 : tiny);
  return y == 0 ? 0 : std::isinf(x) ? 0 : y / x;
}

Twofold root(Twofold a) {
  const double q = std::sqrt(a.high);
  if (!(q > 0)) return {q, 0};
  const Twofold q2 = square(q);
  return joined(q, ((a.high - q2.high) - q2.low + a.low) / (2 * q));
}

/// sqrt(1 - x^2).
Twofold other_side(double x) { return root(sum(1, -x) * sum(1, x)); }

}  // namespace

double sin(double x) {
  if (!(std::abs(x) < std::numeric_limits<double>::infinity())) return x - x;
  if (std::abs(x) < 0x1p-27) return x;
  const Twofold s = sine_of(reduced(x));
  return s.high + s.low;
}

double cos(double x) {
  if (!(std::abs(x) < std::numeric_limits<double>::infinity())) return x - x;
  Reduced r = reduced(x);
  ++r.quarters;
  const Twofold s = sine_of(r);
  return s.high + s.low;
}

double tan(double x) {
  if (!(std::abs(x) < std::numeric_limits<double>::infinity())) return x - x;
  if (std::abs(x) < 0x1p-27) return x;
  Reduced r = reduced(x);
  const Twofold s = sine_of(r);
  ++r.quarters;
  const Twofold t = s / sine_of(r);
  return t.high + t.low;
}

double asin(double x) {
  if (!(std::abs(x) <= 1)) return std::numeric_limits<double>::quiet_NaN();
  if (std::abs(x) < 0x1p-27) return x;
  return std::copysign(angle_at({std::abs(x), 0}, other_side(x), false), x);
}

double acos(double x) {
  if (!(std::abs(x) <= 1)) return std::numeric_limits<double>::quiet_NaN();
  if (std::abs(x) < 0x1p-60) return half_pi.high;
  return angle_at(other_side(x), {std::abs(x), 0}, x < 0);
}

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return x + y;
  const double a = std::abs(x), b = std::abs(y), most = std::max(a, b), least = std::min(a, b);
  const bool left = std::signbit(x);
  if (!(most < std::numeric_limits<double>::infinity()) || least < most * 0x1p-60)
    return std::copysign(odd_angle(b, a, left), y);
  if (most == 0) return std::copysign(left ? 2 * half_pi.high : 0, y);
  // Only the ratio counts: far from the ends of the range nothing is lost.
  const double scale = most > 0x1p900 ? 0x1p-200 : most < 0x1p-800 ? 0x1p200 : 1;
  return std::copysign(angle_at({b * scale, 0}, {a * scale, 0}, left), y);
}

}  // namespace dynasurf::own
