#include "dynasurf/psf_fit/detail/harmonics.hpp"

#include <array>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::psf_fit {
namespace {

/// What makes the mean of a harmonic's square 1, at l * l + l + m for m >= 0.
std::array<double, harmonics_up_to(most_harmonic_degree)> norms() {
  std::array<double, harmonics_up_to(most_harmonic_degree)> norm{};
  for (int m = 0; m <= most_harmonic_degree; ++m) {
    double scale = std::sqrt(m == 0 ? 1.0 : 2.0);
    for (int n = 1; n <= 2 * m; ++n) scale /= std::sqrt(n);
    for (int l = m; l <= most_harmonic_degree; ++l) {
      norm[l * l + l + m] = scale * std::sqrt(2.0 * l + 1);
      scale *= std::sqrt((l + 1.0 - m) / (l + 1.0 + m));
    }
  }
  return norm;
}

}  // namespace

int degree_of_harmonic(int k) {
  int degree = 0;
  while (harmonics_up_to(degree) <= k) ++degree;
  return degree;
}

void real_spherical_harmonics(const Vec3& unit, int degree, std::span<double> out) {
  static const std::array<double, harmonics_up_to(most_harmonic_degree)> norm = norms();
  const double z = unit[2];
  // P holds the associated Legendre functions divided by sin^m, which goes into the powers of x + iy.
  double re = 1, im = 0, p_mm = 1;
  for (int m = 0; m <= degree; ++m) {
    double below = 0, here = p_mm;  // P(l - 1, m), P(l, m)
    for (int l = m; l <= degree; ++l) {
      const std::size_t middle = l * l + l;
      out[middle + m] = norm[middle + m] * here * re;
      if (m > 0) out[middle - m] = norm[middle + m] * here * im;
      const double above = ((2 * l + 1) * z * here - (l + m) * below) / (l - m + 1);
      below = here, here = above;
    }
    p_mm *= 2 * m + 1;
    const double next = re * unit[0] - im * unit[1];
    im = re * unit[1] + im * unit[0];
    re = next;
  }
}

Vec3 fibonacci_direction(int n, int count) {
  const double golden = M_PI * (3 - std::sqrt(5.0));
  const double z = -1 + (2 * n + 1.0) / count;
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * own::cos(golden * n), r * own::sin(golden * n), z};
}

}  // namespace dynasurf::psf_fit
