#include <array>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/parallel.hpp"
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
    if (!(at >= -0.5 && at <= grid.dims[static_cast<std::size_t>(a)] - 0.5)) return false;
  }
  return true;
}

std::vector<double> gaussian_kernel(double sigma_px) {
  const int reach = std::max(1, static_cast<int>(std::ceil(3 * sigma_px)));
  std::vector<double> kernel;
  double sum = 0;
  for (int d = -reach; d <= reach; ++d) {
    kernel.push_back(own::exp(-0.5 * d * d / (sigma_px * sigma_px)));
    sum += kernel.back();
  }
  for (double& w : kernel) w /= sum;
  return kernel;
}

/// Convolves one row of `from` along an axis; beyond the ends the outermost voxels are repeated. A whole row per tap
/// of the kernel: the inner loops run over neighbours in memory.
void convolve_row(const Image& from, Image& to, const std::vector<double>& kernel, int axis, int j, int k) {
  const auto width = static_cast<std::size_t>(from.grid.dims[0]);
  const int reach = static_cast<int>(kernel.size() / 2);
  std::vector<double> sum(width, 0.0);
  if (axis == 0) {
    std::vector<float> padded(width + kernel.size() - 1);
    for (std::size_t i = 0; i < padded.size(); ++i) padded[i] = from.clamped(static_cast<int>(i) - reach, j, k);
    for (std::size_t d = 0; d < kernel.size(); ++d)
      for (std::size_t i = 0; i < width; ++i) sum[i] += kernel[d] * padded[i + d];
  } else {
    for (int d = -reach; d <= reach; ++d) {
      const int row = std::clamp(j + (axis == 1 ? d : 0), 0, from.grid.dims[1] - 1);
      const int slice = std::clamp(k + (axis == 2 ? d : 0), 0, from.grid.dims[2] - 1);
      const float* values = from.values.data() + from.grid.index(0, row, slice);
      const double weight = kernel[static_cast<std::size_t>(d + reach)];
      for (std::size_t i = 0; i < width; ++i) sum[i] += weight * values[i];
    }
  }
  float* result = to.values.data() + to.grid.index(0, j, k);
  for (std::size_t i = 0; i < width; ++i) result[i] = static_cast<float>(sum[i]);
}

}  // namespace

double sample_linear(const Image& image, const Vec3& mm) {
  const Grid& g = image.grid;
  const Place x = place(mm[0], g.spacing[0], g.dims[0]), y = place(mm[1], g.spacing[1], g.dims[1]),
              z = place(mm[2], g.spacing[2], g.dims[2]);
  const std::size_t dx = g.dims[0] > 1 ? 1 : 0, dy = g.dims[1] > 1 ? static_cast<std::size_t>(g.dims[0]) : 0,
                    dz = g.dims[2] > 1 ? g.index(0, 0, 1) : 0;
  const float* v = image.values.data() + g.index(x.low, y.low, z.low);
  const auto along_x = [&](std::size_t at) { return v[at] + x.share * (v[at + dx] - v[at]); };
  const auto along_y = [&](std::size_t at) {
    const double low = along_x(at), high = along_x(at + dy);
    return low + y.share * (high - low);
  };
  const double low = along_y(0), high = along_y(dz);
  return low + z.share * (high - low);
}

double sample_cubic(const Image& image, const Vec3& mm) {
  const Grid& g = image.grid;
  const Place x = place(mm[0], g.spacing[0], g.dims[0]), y = place(mm[1], g.spacing[1], g.dims[1]),
              z = place(mm[2], g.spacing[2], g.dims[2]);
  const auto wx = cubic_weights(x.share), wy = cubic_weights(y.share), wz = cubic_weights(z.share);
  double sum = 0;
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j) {
      double row = 0;
      for (int i = 0; i < 4; ++i)
        row += wx[static_cast<std::size_t>(i)] * image.clamped(x.low - 1 + i, y.low - 1 + j, z.low - 1 + k);
      sum += wz[static_cast<std::size_t>(k)] * wy[static_cast<std::size_t>(j)] * row;
    }
  return sum;
}

Image resample(const Image& image, const Grid& grid) {
  Image result(grid);
  const bool non_negative = std::all_of(image.values.begin(), image.values.end(), [](float v) { return v >= 0; });
  parallel_for(static_cast<std::size_t>(std::max(0, grid.dims[2])), 1, [&](std::size_t begin, std::size_t end) {
    for (int k = static_cast<int>(begin); k < static_cast<int>(end); ++k)
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
  Image from = image, to(image.grid);
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> kernel = gaussian_kernel(sigma_mm / image.grid.spacing[axis]);
    parallel_for(static_cast<std::size_t>(image.grid.dims[2]), 1, [&](std::size_t begin, std::size_t end) {
      for (int k = static_cast<int>(begin); k < static_cast<int>(end); ++k)
        for (int j = 0; j < image.grid.dims[1]; ++j) convolve_row(from, to, kernel, axis, j, k);
    });
    std::swap(from, to);
  }
  return from;
}

}  // namespace dynasurf::image
