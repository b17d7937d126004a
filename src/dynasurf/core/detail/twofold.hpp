#pragma once

namespace dynasurf::own {

/// A number as the sum of two doubles, the second below half a unit in the last place of the first: about 106 bits.
struct Twofold {
  double high = 0, low = 0;
};

/// a + b without loss (Knuth). Where |a| >= |b| is known, `joined` is shorter.
inline Twofold sum(double a, double b) {
  const double s = a + b, of_b = s - a;
  return {s, (a - (s - of_b)) + (b - of_b)};
}

/// a + b without loss, for |a| >= |b| or a = 0 (Dekker).
inline Twofold joined(double a, double b) {
  const double s = a + b;
  return {s, b - (s - a)};
}

/// The 26 upper bits of a number below 2^996, and the rest (Veltkamp).
inline Twofold halves(double a) {
  const double c = 0x1.0000002p27 * a, high = c - (c - a);
  return {high, a - high};
}

/// a b without loss, unless it leaves the range of numbers (Dekker): no fused operation, which machines lack.
inline Twofold product(double a, double b) {
  const Twofold x = halves(a), y = halves(b);
  const double p = a * b;
  return {p, ((x.high * y.high - p) + x.high * y.low + x.low * y.high) + x.low * y.low};
}

inline Twofold square(double a) {
  const Twofold x = halves(a);
  const double p = a * a;
  return {p, ((x.high * x.high - p) + 2 * (x.high * x.low)) + x.low * x.low};
}

inline Twofold operator*(Twofold a, Twofold b) {
  const Twofold p = product(a.high, b.high);
  return joined(p.high, p.low + (a.high * b.low + a.low * b.high));
}

inline Twofold operator+(Twofold a, Twofold b) {
  const Twofold s = sum(a.high, b.high);
  return joined(s.high, s.low + (a.low + b.low));
}

inline Twofold operator/(Twofold a, Twofold b) {
  const double q = a.high / b.high;
  const Twofold p = product(q, b.high);
  return joined(q, ((a.high - p.high) - p.low + (a.low - q * b.low)) / b.high);
}

}  // namespace dynasurf::own
