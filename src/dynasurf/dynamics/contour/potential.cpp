#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/dynamics/contour/contours.hpp"
#include "dynasurf/field/detail/gradient.hpp"
#include "dynasurf/image/detail/gaussian.hpp"

namespace dynasurf::dynamics {
namespace {

constexpr std::array<std::string_view, 4> energy_names{"gradient", "smoothed_gradient", "intensity",
                                                       "smoothed_intensity"};
constexpr std::array<std::string_view, 3> source_names{"gradient", "bright", "dark"};

template <class F>
Image each_pixel(const Grid& grid, F value) {
  Image out(grid);
  for (int j = 0; j < grid.dims[1]; ++j)
    for (int i = 0; i < grid.dims[0]; ++i) out(i, j, 0) = value(i, j);
  return out;
}

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double square = d.squaredNorm();
  const double share = square > 0 ? std::clamp((p - a).dot(d) / square, 0.0, 1.0) : 0.0;
  return (p - a - share * d).norm();
}

double distance_to_stroke(const Vec2& p, const Stroke& stroke) {
  double least = (p - stroke.points.front()).norm();
  for (std::size_t i = 1; i < stroke.points.size(); ++i)
    least = std::min(least, distance_to_segment(p, stroke.points[i - 1], stroke.points[i]));
  return least;
}

}  // namespace

std::span<const std::string_view> names_of(SnakeEnergy) { return energy_names; }
std::span<const std::string_view> names_of(PotentialSource) { return source_names; }

Image plane_of(const Image& volume, int k) {
  const auto& n = volume.grid.dims;
  if (k < 0 || k >= n[2])
    throw InputError("slice " + std::to_string(k) + " of a volume with " + std::to_string(n[2]) + " slices");
  Grid grid;
  grid.dims = {n[0], n[1], 1};
  return each_pixel(grid, [&](int i, int j) { return volume(i, j, k); });
}

Image smoothed_plane(const Image& plane, double sigma_px) {
  if (!(sigma_px >= 0) || sigma_px > 100)
    throw OptionError("smoothed_plane: sigma_px is " + std::to_string(sigma_px) + "; expected 0 to 100");
  if (sigma_px == 0) return plane;
  const std::vector<double> half =
      // Beyond four standard deviations a Gaussian is 0.0003 of its peak.
      image::half_gaussian(sigma_px, std::max(1, ceil_int(4 * sigma_px)));
  return image::convolve_along(image::convolve_along(plane, half, 0), half, 1);
}

Image snake_energy(const Image& plane, SnakeEnergy kind, double sigma_px) {
  const bool smooth = kind == SnakeEnergy::smoothed_gradient || kind == SnakeEnergy::smoothed_intensity;
  Image image = smooth ? smoothed_plane(plane, sigma_px) : plane;
  if (kind == SnakeEnergy::intensity || kind == SnakeEnergy::smoothed_intensity) return image;
  return each_pixel(image.grid,
                    [&](int i, int j) { return -field::detail::gradient_at(image, i, j, 0).squaredNorm(); });
}

Image image_potential(const Image& plane, const Potential& requested) {
  Potential options = requested;
  check_options(options, "potential");
  Image image = smoothed_plane(plane, options.sigma_px);
  if (options.source == PotentialSource::gradient)
    image = each_pixel(image.grid, [&](int i, int j) { return field::detail::gradient_at(image, i, j, 0).norm(); });
  const auto [low, high] = std::minmax_element(image.values.begin(), image.values.end());
  // A gradient has a zero of its own; intensities are counted from their least value.
  const double bottom = options.source == PotentialSource::gradient ? 0 : double{*low};
  const double top = *high, range = top - bottom;
  if (!(range > 0)) return Image(image.grid);
  const bool dark = options.source == PotentialSource::dark;
  for (float& v : image.values) v = (dark ? v - top : bottom - v) / range;
  return image;
}

void add_strokes(Image& energy, std::span<const Stroke> strokes) {
  for (const Stroke& s : strokes) {
    if (s.points.empty() || !(s.width_px > 0) || !std::isfinite(s.strength))
      throw OptionError("a stroke of " + std::to_string(s.points.size()) + " points and width " +
                        std::to_string(s.width_px) + " px; expected points and a positive width");
    for (int j = 0; j < energy.grid.dims[1]; ++j)
      for (int i = 0; i < energy.grid.dims[0]; ++i) {
        const double d = distance_to_stroke(Vec2(i, j), s) / s.width_px;
        energy(i, j, 0) += static_cast<float>(s.strength * own::exp(-d * d / 2));
      }
  }
}

field::VectorField force_of(const Image& energy, double scale) {
  field::VectorField field(energy.grid);
  for (int j = 0; j < energy.grid.dims[1]; ++j)
    for (int i = 0; i < energy.grid.dims[0]; ++i) {
      const Vec3 g = -scale * field::detail::gradient_at(energy, i, j, 0);
      const std::size_t at = energy.grid.index(i, j, 0);
      field.x[at] = g.x();
      field.y[at] = g.y();
    }
  return field;
}

field::VectorField scaled_to_one(field::VectorField field) {
  float largest = 0;
  for (std::size_t n = 0; n < field.x.size(); ++n)
    largest = std::max<float>(largest, own::hypot(field.x[n], field.y[n]));
  if (largest > 0)
    for (std::size_t n = 0; n < field.x.size(); ++n) field.x[n] /= largest, field.y[n] /= largest;
  return field;
}

Vec2 force_at(const field::VectorField& field, const Vec2& p) {
  // Fields are sampled in mm of the grid frame; a plane is its slice at 0.
  return field::sample(field, Vec3(p.x() * field.grid.spacing.x(), p.y() * field.grid.spacing.y(), 0),
                       field::Sampling::trilinear)
      .head<2>();
}

}  // namespace dynasurf::dynamics
