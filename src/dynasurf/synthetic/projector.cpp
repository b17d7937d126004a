#include "dynasurf/synthetic/detail/projector.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/simd.hpp"
#include "dynasurf/synthetic/detail/render.hpp"

namespace dynasurf::synthetic {
namespace {

std::size_t at(Index row, int n) { return row * n; }

/// Lies at `a` bins across and depth `b`: p = s (cos, sin) + t (sin, -cos) with t towards the camera.
Taps taps_at(const ViewModel& view, int a, int b) {
  const double middle = (view.n - 1) / 2.0, s = a - middle, t = middle - b;
  const double x = middle + s * view.cos + t * view.sin, y = middle + s * view.sin - t * view.cos;
  const int x0 = floor_int(x), y0 = floor_int(y);
  const double fx = x - x0, fy = y - y0;
  Taps taps;
  for (int c = 0; c < 4; ++c) {
    const int cx = x0 + c % 2, cy = y0 + c / 2;
    if (cx < 0 || cy < 0 || cx >= view.n || cy >= view.n) continue;
    taps.column[c] = cy * view.n + cx;
    taps.weight[c] = (c % 2 ? fx : 1 - fx) * (c / 2 ? fy : 1 - fy);
  }
  return taps;
}

// What takes its time in a view: plain loops over columns, for any instruction set. They alone are compiled several
// times, and what they call is inlined into them.

/// One plane of the rotated volume. Returns false when it is empty.
DYNASURF_CLONES
bool rotate_plane(const ViewModel& view, const Columns& volume, int b, float* __restrict plane) {
  const int n = view.n;
  const std::vector<float> nothing(n, 0.0F);
  bool any = false;
  for (int a = 0; a < n; ++a) {
    const Taps& taps = view.taps[at(b, n) + a];
    std::array<const float*, 4> column;
    bool any_here = false;
    for (int c = 0; c < 4; ++c) {
      const int place = taps.column[c];
      const bool is_there = place >= 0 && taps.weight[c] != 0 && (volume.is_empty.empty() || !volume.is_empty[place]);
      column[c] = is_there ? volume.values.data() + at(place, n) : nothing.data();
      any_here |= is_there;
    }
    float* row = plane + at(a, n);
    any |= any_here;
    if (!any_here) {
      std::fill_n(row, n, 0.0F);
      continue;
    }
    const auto [w0, w1, w2, w3] = taps.weight;
    const auto [c0, c1, c2, c3] = column;
    for (int z = 0; z < n; ++z) row[z] = w0 * c0[z] + w1 * c1[z] + w2 * c2[z] + w3 * c3[z];
  }
  return any;
}

DYNASURF_CLONES
void add_plane(const ViewModel& view, const float* __restrict plane, int b, Columns& sum) {
  const int n = view.n;
  for (int a = 0; a < n; ++a) {
    const Taps& taps = view.taps[at(b, n) + a];
    for (int c = 0; c < 4; ++c) {
      if (taps.column[c] < 0 || taps.weight[c] == 0) continue;
      float* __restrict column = sum.values.data() + at(taps.column[c], n);
      const float w = taps.weight[c];
      const float* row = plane + at(a, n);
      for (int z = 0; z < n; ++z) column[z] += w * row[z];
    }
  }
}

/// (w, 1 - 2w, w) over the rows of a square: its variance is 2 w. What leaves the camera is lost.
DYNASURF_INLINE void blur_across(const float* __restrict from, float* __restrict to, int n, float w) {
  const float middle = 1 - 2 * w;
  const std::vector<float> nothing(n, 0.0F);
  for (int a = 0; a < n; ++a) {
    const float* here = from + at(a, n);
    const float* left = a > 0 ? here - n : nothing.data();
    const float* right = a + 1 < n ? here + n : nothing.data();
    float* out = to + at(a, n);
    for (int z = 0; z < n; ++z) out[z] = middle * here[z] + w * (left[z] + right[z]);
  }
}

DYNASURF_INLINE void blur_along(const float* __restrict from, float* __restrict to, int n, float w) {
  const float middle = 1 - 2 * w;
  for (int a = 0; a < n; ++a) {
    const float* in = from + at(a, n);
    float* out = to + at(a, n);
    out[0] = middle * in[0] + w * in[1];
    for (int z = 1; z + 1 < n; ++z) out[z] = middle * in[z] + w * (in[z - 1] + in[z + 1]);
    out[n - 1] = middle * in[n - 1] + w * in[n - 2];
  }
}

/// Kernels of three bins that are used again and again keep the variance exact and become Gaussian.
DYNASURF_CLONES
void blur_square(float* square, float* spare, int n, double across, double along) {
  constexpr double most_at_once = 0.5;
  const int passes = ceil_int(std::max(across, along) / most_at_once);
  for (int p = 0; p < passes; ++p) {
    blur_across(square, spare, n, across / (2 * passes));
    blur_along(spare, square, n, along / (2 * passes));
  }
}

/// Convolves lines of `count` values, `stride` apart, with (1 - q) / (1 + q) q^|n|, over `width` neighbouring lines.
void spread_line(float* line, int count, std::size_t stride, int width, float q) {
  const float scale = (1 - q) / (1 + q);
  std::vector<float> before(at(count, width), 0.0F), after(width, 0.0F);
  for (int i = 1; i < count; ++i)
    for (int w = 0; w < width; ++w)
      before[at(i, width) + w] = q * (before[at(i - 1, width) + w] + line[(i - 1) * stride + w]);
  for (int i = count - 1; i >= 0; --i)
    for (int w = 0; w < width; ++w) {
      const float here = line[i * stride + w];
      line[i * stride + w] = scale * (here + before[at(i, width) + w] + after[w]);
      after[w] = q * (after[w] + here);
    }
}

void spread_scatter(std::vector<float>& square, int n, double share) {
  const float q = share;
  spread_line(square.data(), n, n, n, q);
  for (int a = 0; a < n; ++a) spread_line(square.data() + at(a, n), n, 1, 1, q);
}

/// (1 - exp(-x)) / x by its series: the mean of exp over a voxel that x attenuates. For x up to 1 within 1e-6. Made of
/// sums and products, so that it is fast and the same everywhere.
DYNASURF_INLINE float mean_transmission(float x) {
  constexpr float parts[] = {1.0F / 2, 1.0F / 3, 1.0F / 4, 1.0F / 5, 1.0F / 6, 1.0F / 7, 1.0F / 8, 1.0F / 9};
  float sum = 0;
  for (int k = 7; k >= 0; --k) sum = (1 + sum) * (-x * parts[k]);
  return 1 + sum;
}

/// Photons on their way out through `here`, 1/mm: the part that is `left` before it, and what gets `through` from its
/// middle.
DYNASURF_CLONES
void pass(std::span<const float> here, float step_mm, float* __restrict left, float* __restrict through) {
  const float* const __restrict per_mm = here.data();
  for (std::size_t v = 0; v < here.size(); ++v) {
    const float x = per_mm[v] * step_mm, mean = mean_transmission(x);
    through[v] = left[v] * mean;
    left[v] *= 1 - x * mean;  // exp(-x)
  }
}

/// Scattered photons of the way out: `scatter` of each that gets through and attenuation length of its `path`.
DYNASURF_CLONES
void scatter_on_the_way(std::span<const float> here, float step_mm, float scatter, const float* __restrict through,
                        float* __restrict path, float* __restrict buildup) {
  const float* const __restrict per_mm = here.data();
  for (std::size_t v = 0; v < here.size(); ++v) {
    const float x = per_mm[v] * step_mm;
    buildup[v] = scatter * (path[v] + x / 2) * through[v];
    path[v] += x;
  }
}

void attenuate(ViewModel& view, const ViewSettings& s) {
  const int n = view.n;
  const std::size_t plane = at(n, n);
  view.transmission.resize(plane * n);
  if (s.scatter > 0) view.buildup.resize(view.transmission.size());
  std::vector<float> left(plane, 1.0F), path(plane, 0.0F), here(plane);
  const float step = s.voxel_mm, scatter = s.scatter;
  for (int b = 0; b < n; ++b) {
    rotate_plane(view, *s.attenuation, b, here.data());
    float* through = view.transmission.data() + plane * b;
    pass(here, step, left.data(), through);
    if (s.scatter > 0) scatter_on_the_way(here, step, scatter, through, path.data(), view.buildup.data() + plane * b);
  }
}

void widen(ViewModel& view, const ViewSettings& s) {
  const int n = view.n;
  const auto variance = [&](int b, double taken) {
    const double t = ((n - 1) / 2.0 - b) * s.voxel_mm, distance = std::max(0.0, s.radius_mm - t);
    const CameraResponse& r = *s.response;
    const double aperture = r.aperture_mm + r.growth * distance;
    const double sigma = sigma_of_fwhm(std::sqrt(r.intrinsic_mm * r.intrinsic_mm + aperture * aperture)) / s.voxel_mm;
    return std::max(0.0, sigma * sigma - taken);
  };
  // Linear interpolation on a rotated lattice has a variance of 1/6 voxel² already, in every direction; at quarter
  // turns the lattices are one.
  const double of_rotation = std::abs(view.cos * view.sin) < 1e-9 ? 0 : 1.0 / 6;
  for (int b = 0; b + 1 < n; ++b) {
    view.across_steps.push_back(variance(b + 1, of_rotation) - variance(b, of_rotation));
    view.along_steps.push_back(variance(b + 1, 0) - variance(b, 0));
  }
  view.across_steps.insert(view.across_steps.begin(), variance(0, of_rotation));
  view.along_steps.insert(view.along_steps.begin(), variance(0, 0));
}

}  // namespace

Columns columns_of(const Image& image) {
  const int n = image.grid.dims[0];
  Columns columns(n);
  columns.is_empty.assign(at(n, n), 1);
  for (int k = 0; k < n; ++k)
    for (int c = 0; c < n * n; ++c) {
      const float value = image.values[at(k, n * n) + c];
      columns.values[at(c, n) + k] = value;
      if (value != 0) columns.is_empty[c] = 0;
    }
  return columns;
}

Image image_of(const Columns& columns, const Grid& grid) {
  const int n = columns.n;
  Image image(grid);
  for (int k = 0; k < n; ++k)
    for (int c = 0; c < n * n; ++c) image.values[at(k, n * n) + c] = columns.values[at(c, n) + k];
  return image;
}

ViewModel make_view(int n, const ViewSettings& settings) {
  ViewModel view;
  view.n = n;
  const double angle = settings.angle_deg * (M_PI / 180);
  view.cos = own::cos(angle), view.sin = own::sin(angle);
  view.taps.reserve(at(n, n));
  for (int b = 0; b < n; ++b)
    for (int a = 0; a < n; ++a) view.taps.push_back(taps_at(view, a, b));
  if (settings.attenuation != nullptr) attenuate(view, settings);
  if (settings.response != nullptr) widen(view, settings);
  view.scatter_share = own::exp(-settings.scatter_slope_per_mm * settings.voxel_mm);
  return view;
}

namespace {

/// Adds products, of each value with one of `by`.
DYNASURF_CLONES
void add_products(std::span<const float> values, const float* __restrict by, float* __restrict sum) {
  const float* const __restrict value = values.data();
  for (std::size_t v = 0; v < values.size(); ++v) sum[v] += by[v] * value[v];
}

}  // namespace

void project_view(const ViewModel& view, const Columns& activity, std::span<float> bins, std::span<float> scattered) {
  const int n = view.n;
  const std::size_t square = at(n, n);
  std::vector<float> sum(square, 0.0F), plane(square), spare(square), aside;
  if (!view.buildup.empty() && !scattered.empty()) aside.assign(square, 0.0F);
  bool any = false;
  // From the far side on: between two planes the sum is widened by the difference of their point spreads, a narrow blur
  // for each plane in place of a wide one.
  for (int b = n - 1; b >= 0; --b) {
    if (rotate_plane(view, activity, b, plane.data())) {
      any = true;
      if (view.transmission.empty())
        for (std::size_t v = 0; v < square; ++v) sum[v] += plane[v];
      else
        add_products(plane, &view.transmission[square * b], sum.data());
      if (!aside.empty()) add_products(plane, &view.buildup[square * b], aside.data());
    }
    if (any && !view.across_steps.empty())
      blur_square(sum.data(), spare.data(), n, view.across_steps[b], view.along_steps[b]);
  }
  for (std::size_t v = 0; v < square; ++v) bins[v] += sum[v];
  if (aside.empty() || !any) return;
  spread_scatter(aside, n, view.scatter_share);
  for (std::size_t v = 0; v < square; ++v) scattered[v] += aside[v];
}

void back_project_view(const ViewModel& view, std::span<const float> bins, Columns& sum) {
  const int n = view.n;
  const std::size_t square = at(n, n);
  // The transpose of project_view: the transposes of its steps, in reverse order.
  std::vector<float> here(bins.begin(), bins.end()), plane(square), spare(square);
  for (int b = 0; b < n; ++b) {
    if (!view.across_steps.empty())
      blur_square(here.data(), spare.data(), n, view.across_steps[b], view.along_steps[b]);
    if (view.transmission.empty()) {
      add_plane(view, here.data(), b, sum);
      continue;
    }
    const float* through = &view.transmission[square * b];
    for (std::size_t v = 0; v < square; ++v) plane[v] = through[v] * here[v];
    add_plane(view, plane.data(), b, sum);
  }
}

void widen_square(std::span<float> square, int n, double across, double along) {
  std::vector<float> spare(square.size());
  blur_square(square.data(), spare.data(), n, across, along);
}

std::vector<float> transposed(std::span<const float> square, int n) {
  std::vector<float> result(square.size());
  for (int a = 0; a < n; ++a)
    for (int z = 0; z < n; ++z) result[at(z, n) + a] = square[at(a, n) + z];
  return result;
}

}  // namespace dynasurf::synthetic
