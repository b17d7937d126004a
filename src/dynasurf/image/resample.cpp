#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "dynasurf/core/detail/simd.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/image/detail/gaussian.hpp"
#include "dynasurf/image/detail/linear_sampler.hpp"
#include "dynasurf/image/intensity.hpp"

namespace dynasurf::image {
namespace {

/// Keys' cubic weights of the four voxels around a place.
std::array<double, 4> cubic_weights(double t) {
  return {((-0.5 * t + 1) * t - 0.5) * t, (1.5 * t - 2.5) * t * t + 1, ((-1.5 * t + 2) * t + 0.5) * t,
          (0.5 * t - 0.5) * t * t};
}

bool holds(const Grid& grid, const Vec3& mm) {
  for (int a = 0; a < 3; ++a) {
    const double at = mm[a] / grid.spacing[a];
    if (!(at >= -0.5 && at <= grid.dims[a] - 0.5)) return false;
  }
  return true;
}

}  // namespace

double sample_linear(const Image& image, const Vec3& mm) { return LinearSampler(image)(mm); }

DYNASURF_CLONES
void LinearSampler::at_all(const double* x, const double* y, const double* z, std::size_t count, double* to) const {
  const LinearSampler own = *this;  // on the stack, where no store reaches it
  if (size_ <= std::numeric_limits<std::int32_t>::max())
    for (std::size_t n = 0; n < count; ++n) to[n] = own.at<std::int32_t>(x[n], y[n], z[n]);
  else
    for (std::size_t n = 0; n < count; ++n) to[n] = own.at<Index>(x[n], y[n], z[n]);
}

double sample_cubic(const Image& image, const Vec3& mm) {
  const Grid& g = image.grid;
  const PlaceOnAxis x = place_on(sampled_axis(g, 0), mm[0]), y = place_on(sampled_axis(g, 1), mm[1]),
                    z = place_on(sampled_axis(g, 2), mm[2]);
  const auto wx = cubic_weights(x.share), wy = cubic_weights(y.share), wz = cubic_weights(z.share);
  const auto sum_of = [&](const auto& voxel) {
    double sum = 0;
    for (int k = 0; k < 4; ++k)
      for (int j = 0; j < 4; ++j) {
        double row = 0;
        for (int i = 0; i < 4; ++i) row += wx[i] * voxel(i, j, k);
        sum += wz[k] * wy[j] * row;
      }
    return sum;
  };
  const Index3 first{x.low - 1, y.low - 1, z.low - 1};
  if (g.contains(first[0], first[1], first[2]) && g.contains(first[0] + 3, first[1] + 3, first[2] + 3)) {
    const float* const values = &image.values[index_in(g.dims, first)];
    const std::size_t width = g.dims[0], slice = g.slice_size();
    return sum_of([&](int i, int j, int k) { return values[i + j * width + k * slice]; });
  }
  return sum_of([&](int i, int j, int k) { return image.clamped(first[0] + i, first[1] + j, first[2] + k); });
}

Image resample(const Image& image, const Grid& grid) {
  Image result(grid);
  const bool non_negative = std::all_of(image.values.begin(), image.values.end(), [](float v) { return v >= 0; });
  parallel_for(std::max(0, grid.dims[2]), 1, [&](int begin, int end) {
    for (int k = begin; k < end; ++k)
      for (int j = 0; j < grid.dims[1]; ++j)
        for (int i = 0; i < grid.dims[0]; ++i) {
          const Vec3 mm = to_grid(image.grid, to_world(grid, centre_of(grid, {i, j, k})));
          if (!holds(image.grid, mm)) continue;
          const double value = sample_cubic(image, mm);
          result(i, j, k) = non_negative ? std::max(0.0, value) : value;
        }
  });
  return result;
}

Image smooth_gaussian(const Image& image, double sigma_mm) {
  if (!(sigma_mm > 0)) return image;
  Image smooth = image;
  for (int axis = 0; axis < 3; ++axis)
    smooth = convolve_along(smooth, half_gaussian(sigma_mm / image.grid.spacing[axis]), axis);
  return smooth;
}

}  // namespace dynasurf::image
