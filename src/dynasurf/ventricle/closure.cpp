#include "dynasurf/ventricle/detail/closure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/detail/visit_marked.hpp"
#include "dynasurf/image/detail/components.hpp"

namespace dynasurf::ventricle {
namespace {

using image::Pixel;

constexpr int directions = 64;
constexpr double turn = 2 * std::numbers::pi;

double wall_brightness(const Image& image, const Circle& circle, int k) {
  double sum = 0;
  for (int d = 0; d < directions; ++d) {
    const double angle = turn * d / directions;
    // The brightest on each ray is the wall, wherever it lies; the circle is only known to enclose it.
    float brightest = 0;
    for (double r = 0; r <= circle.radius_px; r += 0.5)
      brightest = std::max(brightest, image.clamped(round_int(circle.x_px + r * own::cos(angle)),
                                                    round_int(circle.y_px + r * own::sin(angle)), k));
    sum += brightest;
  }
  return sum / directions;
}

std::vector<Pixel> border_pixels(const Image& border, int k) {
  std::vector<Pixel> pixels;
  visit_marked(
      border, k, [](float voxel) { return voxel > 0; },
      [&](int i, int j) {
        pixels.push_back({i, j});
      });
  return pixels;
}

using RadiusOf = std::array<std::optional<double>, directions>;

/// Fills directions without a radius from the two nearest ones that have one, around the circle.
void bridge_gaps(RadiusOf& radius) {
  std::vector<int> known;
  for (int d = 0; d < directions; ++d)
    if (radius[d]) known.push_back(d);
  if (known.empty()) return;
  for (std::size_t n = 0; n < known.size(); ++n) {
    const int from = known[n], to = n + 1 < known.size() ? known[n + 1] : known[0] + directions;
    const double a = *radius[from], b = *radius[to % directions];
    for (int d = from + 1; d < to; ++d) radius[d % directions] = a + (b - a) * (d - from) / (to - from);
  }
}

int direction_of(double x, double y) { return round_int((own::atan2(y, x) / turn + 1) * directions) % directions; }

/// The radii of a ring around a point, in the directions in which it has pixels.
RadiusOf radii_of(const std::vector<Pixel>& ring, const image::PixelMean& centre) {
  RadiusOf radii;
  for (const Pixel& p : ring) {
    const double x = p.i - centre.x_px, y = p.j - centre.y_px;
    auto& r = radii[direction_of(x, y)];
    // Where a direction holds several pixels the outermost counts: the disc reaches to the outside of the ring.
    r = std::max(r.value_or(0), own::hypot(x, y));
  }
  return radii;
}

/// Fills the inside of the ring in the first of `slices`, drawn from that slice and, where it has gaps, from the others
/// in order.
void fill_disc(Image& border, const std::vector<int>& slices) {
  std::optional<image::PixelMean> centre;
  RadiusOf radius;
  const auto has_gaps = [&] { return std::find(radius.begin(), radius.end(), std::nullopt) != radius.end(); };
  for (std::size_t n = 0; n < slices.size() && has_gaps(); ++n) {
    const std::vector<Pixel> ring = border_pixels(border, slices[n]);
    if (ring.empty()) continue;
    if (!centre) centre = image::mean_of(ring);
    const RadiusOf here = radii_of(ring, *centre);
    for (std::size_t d = 0; d < directions; ++d)
      if (!radius[d]) radius[d] = here[d];
  }
  if (!centre) return;
  bridge_gaps(radius);
  double longest = 0;
  for (const auto& r : radius) longest = std::max(longest, *r);
  for (int j = 0; j < border.grid.dims[1]; ++j)
    for (int i = 0; i < border.grid.dims[0]; ++i) {
      const double x = i - centre->x_px, y = j - centre->y_px;
      if (std::max(std::abs(x), std::abs(y)) > longest + 1) continue;
      // Rounding must not leave the ring itself out.
      if (own::hypot(x, y) <= *radius[direction_of(x, y)] + 1e-9) border(i, j, slices[0]) = 1;
    }
}

}  // namespace

int find_base_slice(const Image& image, const Labels& labels, double base_level, Notes& notes) {
  const int slices = image.grid.dims[2];
  int lowest = slices, highest = -1;
  for (int k = 0; k < slices; ++k)
    for (std::size_t v = 0; v < image.grid.index(0, 0, 1); ++v)
      if (labels.borders.values[image.grid.index(0, 0, k) + v] != 0) {
        lowest = std::min(lowest, k), highest = std::max(highest, k);
        break;
      }
  if (highest < 0) return -1;

  std::vector<double> brightness(slices);
  for (int k = 0; k < slices; ++k) brightness[k] = wall_brightness(image, labels.circle, k);
  const double needed =
      base_level * upper_median(std::vector<double>(brightness.begin() + lowest, brightness.begin() + highest + 1));

  int k = (lowest + highest) / 2;
  while (k + 1 < slices && brightness[k + 1] >= needed) ++k;
  if (k == slices - 1)
    notes.push_back({Severity::warning, "base.cut_off",
                     "the wall is still bright in the last slice; the base may lie outside the volume"});
  return k;
}

int slice_above(const Grid& grid, const heart::BasePlane& world_plane, double radius_mm) {
  const heart::BasePlane plane = to_grid(grid, world_plane);
  // The plane rises from its point by the tangent of its lean.
  const double across = own::hypot(plane.normal[0], plane.normal[1]);
  const double rise = plane.normal[2] > 0 ? radius_mm * across / plane.normal[2] : 0;
  const Index3 voxel = voxel_of(grid, {0, 0, plane.point[2] + rise});
  return std::clamp(voxel[2], 0, grid.dims[2] - 1);
}

Image close_border(const Image& border, int base_slice) {
  Image closed = border;
  const int slices = border.grid.dims[2];
  for (std::size_t v = border.grid.index(0, 0, 1) * std::clamp(base_slice + 1, 0, slices); v < closed.values.size();
       ++v)
    closed.values[v] = 0;
  int lowest = -1;
  for (int k = 0; k < slices && lowest < 0; ++k)
    if (!border_pixels(closed, k).empty()) lowest = k;
  if (lowest < 0) return closed;

  std::vector<int> downwards;  // the ring may be torn or lost at the base: what lies nearest below completes it
  for (int k = base_slice; k >= lowest; --k) downwards.push_back(k);
  fill_disc(closed, downwards);
  fill_disc(closed, {lowest});
  return closed;
}

Image with_room(Image border, int voxels) {
  const Grid& old = border.grid;
  Index3 low{old.dims}, high{-1, -1, -1};
  for (int k = 0; k < old.dims[2]; ++k)
    visit_marked(border, k, [&](int i, int j) {
      const Index3 at{i, j, k};
      for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], at[a]), high[a] = std::max(high[a], at[a]);
    });
  if (high[0] < 0) return border;

  Grid grid = old;
  Index3 before{};
  for (std::size_t a = 0; a < 3; ++a) {
    before[a] = std::max(0, voxels - low[a]);
    grid.dims[a] += before[a] + std::max(0, voxels - (old.dims[a] - 1 - high[a]));
  }
  if (grid.dims == old.dims) return border;
  grid.origin = to_world(old, -centre_of(old, before));
  Image roomy(grid);
  for (int k = 0; k < old.dims[2]; ++k)
    for (int j = 0; j < old.dims[1]; ++j)
      std::copy_n(&border(0, j, k), old.dims[0], &roomy(before[0], j + before[1], k + before[2]));
  return roomy;
}

Image spread_to(const Image& image, const Grid& grid) {
  // with_room only ever adds voxels: a grid of the same size is the same grid.
  if (image.grid.dims == grid.dims) return image;
  const Index3 shift = voxel_of(image.grid, to_grid(image.grid, grid.origin));
  Image spread(grid);
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) spread(i, j, k) = image.clamped(i + shift[0], j + shift[1], k + shift[2]);
  return spread;
}

}  // namespace dynasurf::ventricle
