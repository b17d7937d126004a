#include "dynasurf/mesh/detail/predicates.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "dynasurf/core/detail/twofold.hpp"

namespace dynasurf::mesh {
namespace {

/// A number as a sum of doubles of growing size that do not overlap: no digit is lost. Only the rare undecided cases
/// come here, so clarity goes before speed.
class Exact {
 public:
  Exact() = default;
  /// a - b.
  Exact(double a, double b) {
    const double high = a - b, b_part = a - high, a_part = high + b_part;
    keep((a - a_part) + (b_part - b));
    keep(high);
  }

  Exact operator+(const Exact& other) const {
    Exact sum = *this;
    for (const double term : other.terms_) sum.add(term);
    return sum;
  }
  Exact operator-(const Exact& other) const {
    Exact difference = *this;
    for (const double term : other.terms_) difference.add(-term);
    return difference;
  }
  Exact operator*(const Exact& other) const {
    Exact product;
    for (const double a : terms_)
      for (const double b : other.terms_) {
        const double high = a * b;
        product.add(std::fma(a, b, -high));
        product.add(high);
      }
    return product;
  }
  int sign() const { return terms_.empty() ? 0 : terms_.back() > 0 ? 1 : -1; }

 private:
  void keep(double term) {
    if (term != 0) terms_.push_back(term);
  }
  /// Shewchuk's grow-expansion.
  void add(double term) {
    std::vector<double> old;
    old.swap(terms_);
    for (const double e : old) {
      const double sum = term + e, e_part = sum - term;
      keep((term - (sum - e_part)) + (e - e_part));
      term = sum;
    }
    keep(term);
  }

  std::vector<double> terms_;  // the largest last
};

constexpr double half_ulp = std::numeric_limits<double>::epsilon() / 2;
constexpr double bound_2d = (3 + 16 * half_ulp) * half_ulp;
constexpr double bound_3d = (7 + 56 * half_ulp) * half_ulp;

int sign_of(double x) { return (x > 0) - (x < 0); }

int orient3d_exactly(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Exact u[3], v[3], w[3];
  for (int i = 0; i < 3; ++i) {
    u[i] = Exact(a[i], d[i]);
    v[i] = Exact(b[i], d[i]);
    w[i] = Exact(c[i], d[i]);
  }
  const auto minor = [](const Exact& p, const Exact& q, const Exact& r, const Exact& s) { return p * s - q * r; };
  return (u[2] * minor(v[0], v[1], w[0], w[1]) + v[2] * minor(w[0], w[1], u[0], u[1]) +
          w[2] * minor(u[0], u[1], v[0], v[1]))
      .sign();
}

/// The sign by arithmetic with twice the digits; none where rounding could still have turned it. `size`: sum of the
/// determinant's terms without their signs.
std::optional<int> orient3d_twofold(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double size) {
  using own::Twofold;
  constexpr double bound = 0x1p-94;    // about ten operations, each within 2^-100 of its terms
  constexpr double smallest = 1e-250;  // below it digits get lost under the smallest number
  if (!(size > smallest)) return std::nullopt;
  Twofold u[3], v[3], w[3];
  for (int i = 0; i < 3; ++i) {
    u[i] = own::sum(a[i], -d[i]);
    v[i] = own::sum(b[i], -d[i]);
    w[i] = own::sum(c[i], -d[i]);
  }
  const auto minor = [](Twofold p, Twofold q, Twofold r, Twofold s) {
    const Twofold back = q * r;
    return p * s + Twofold{-back.high, -back.low};
  };
  const Twofold det = u[2] * minor(v[0], v[1], w[0], w[1]) + v[2] * minor(w[0], w[1], u[0], u[1]) +
                      w[2] * minor(u[0], u[1], v[0], v[1]);
  if (std::abs(det.high) > bound * size) return sign_of(det.high);
  return std::nullopt;
}

/// Four points of a plane across an axis: no digit is lost between them.
bool share_coordinate(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  for (int i = 0; i < 3; ++i)
    if (a[i] == d[i] && b[i] == d[i] && c[i] == d[i]) return true;
  return false;
}

}  // namespace

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = a - d, v = b - d, w = c - d;
  const double vw = v[0] * w[1], wv = w[0] * v[1], wu = w[0] * u[1], uw = u[0] * w[1], uv = u[0] * v[1],
               vu = v[0] * u[1];
  const double det = u[2] * (vw - wv) + v[2] * (wu - uw) + w[2] * (uv - vu);
  const double size = (std::abs(vw) + std::abs(wv)) * std::abs(u[2]) + (std::abs(wu) + std::abs(uw)) * std::abs(v[2]) +
                      (std::abs(uv) + std::abs(vu)) * std::abs(w[2]);
  if (std::abs(det) > bound_3d * size) return sign_of(det);
  if (share_coordinate(a, b, c, d)) return 0;
  // The lid of a cut surface lies in a plane but for its last digits: many come here, few go on.
  if (const auto sign = orient3d_twofold(a, b, c, d, size)) return *sign;
  return orient3d_exactly(a, b, c, d);
}

int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int left_out) {
  const int x = (left_out + 1) % 3, y = (left_out + 2) % 3;
  const double left = (a[x] - c[x]) * (b[y] - c[y]), right = (a[y] - c[y]) * (b[x] - c[x]);
  const double det = left - right;
  if (std::abs(det) > bound_2d * (std::abs(left) + std::abs(right))) return sign_of(det);
  return (Exact(a[x], c[x]) * Exact(b[y], c[y]) - Exact(a[y], c[y]) * Exact(b[x], c[x])).sign();
}

}  // namespace dynasurf::mesh
