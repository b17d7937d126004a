#include <array>
#include <cmath>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/image/detail/gaussian.hpp"
#include "dynasurf/image/detail/linear_sampler.hpp"
#include "dynasurf/image/intensity.hpp"

namespace dynasurf::image {
namespace {

/// A point's place between voxels along one axis.
struct Place {
  int low;
  double share;  // 0 at `low`, 1 at the next voxel
};

Place place(double mm, double spacing, int count) {
  const double at = std::clamp(mm / spacing, 0.0, count - 1.0);
  const int low = std::min(static_cast<int>(at), std::max(0, count - 2));
  return {low, at - low};
}

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

double sample_cubic(const Image& image, const Vec3& mm) {
  const Grid& g = image.grid;
  const Place x = place(mm[0], g.spacing[0], g.dims[0]), y = place(mm[1], g.spacing[1], g.dims[1]),
              z = place(mm[2], g.spacing[2], g.dims[2]);
  const auto wx = cubic_weights(x.share), wy = cubic_weights(y.share), wz = cubic_weights(z.share);
  double sum = 0;
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j) {
      double row = 0;
      for (int i = 0; i < 4; ++i) row += wx[i] * image.clamped(x.low - 1 + i, y.low - 1 + j, z.low - 1 + k);
      sum += wz[k] * wy[j] * row;
    }
  return sum;
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
          result(i, j, k) = static_cast<float>(non_negative ? std::max(0.0, value) : value);
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
