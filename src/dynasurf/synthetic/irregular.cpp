#include "dynasurf/synthetic/detail/irregular.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/synthetic/detail/render.hpp"

namespace dynasurf::synthetic {
namespace {

/// Tails reach this many times as far as the rest of the point spread.
constexpr double tail_width = 2;

double height_of(const Vec3& p, double base_z) { return std::clamp(p[2] / base_z, 0.0, 1.0); }

/// The image blurred on from one width to a larger one.
Image blurred_on(const Image& image, double from_fwhm, double to_fwhm) {
  const double more = to_fwhm * to_fwhm - from_fwhm * from_fwhm;
  return more > 0 ? blur(image, std::sqrt(more)) : image;
}

}  // namespace

double width_factor(const Irregularity& o, const Vec3& p, double base_z) {
  if (o.walls == 0) return 1;
  const double u = height_of(p, base_z), angle = own::atan2(p[1], p[0]);
  const double septum = std::max(0.0, -own::cos(angle));  // towards -x
  const double shape = -1.2 * septum * septum * own::sin(M_PI * u) + 0.6 * own::cos(2 * angle - 1) +
                       0.5 * own::cos(angle - 5 * u) + 0.3 * own::cos(5 * angle + 7 * u);
  return 1 + 0.06 * o.walls * std::sqrt(u) * shape;
}

double outer_width_factor(const Irregularity& o, const Vec3& p, double base_z) {
  if (o.walls == 0) return 1;
  const double u = height_of(p, base_z), angle = own::atan2(p[1], p[0]);
  const double thickness = own::cos(angle + 2) + 0.7 * own::cos(3 * angle - 4 * u) + 0.6 * own::cos(6 * u);
  return width_factor(o, p, base_z) * (1 + 0.025 * o.walls * std::sqrt(u) * thickness);
}

bool in_papillary(const Irregularity& o, const VentricleShape& shape, const Vec3& p) {
  if (o.papillary_mm <= 0) return false;
  const double u = height_of(p, shape.base_z);
  if (u < 0.3 || u > 0.7) return false;
  const double h = (p[2] - shape.centre_z) / shape.endo_half_length;
  const double wall = shape.endo_radius * std::sqrt(std::max(0.0, 1 - h * h));
  for (const double angle : {0.9, 2.4}) {
    const double away = std::max(0.0, wall - 0.8 * o.papillary_mm);
    if (own::hypot(p[0] - away * own::cos(angle), p[1] - away * own::sin(angle)) <= o.papillary_mm) return true;
  }
  return false;
}

double narrow_fwhm(const Irregularity& o, double fwhm_mm) { return (1 - o.depth) * fwhm_mm; }

Image see_unevenly(const Irregularity& o, const Image& narrow, double narrow_fwhm_mm, double fwhm_mm) {
  Image image = narrow;
  if (o.depth > 0) {
    // A mixture of two widths has the mean of their variances: from (1 - depth) to (1 + depth) times the width.
    const Image wide = blurred_on(narrow, narrow_fwhm_mm, (1 + o.depth) * fwhm_mm);
    const Index3 dims = image.grid.dims;
    for (int k = 0; k < dims[2]; ++k)
      for (int j = 0; j < dims[1]; ++j) {
        const float share = (j + 0.5) / dims[1];
        for (int i = 0; i < dims[0]; ++i) image(i, j, k) = (1 - share) * narrow(i, j, k) + share * wide(i, j, k);
      }
  }
  if (o.tails > 0) {
    const Image far = blurred_on(image, fwhm_mm, tail_width * fwhm_mm);
    const float share = o.tails;
    for (std::size_t v = 0; v < image.values.size(); ++v)
      image.values[v] = (1 - share) * image.values[v] + share * far.values[v];
  }
  return image;
}

}  // namespace dynasurf::synthetic
