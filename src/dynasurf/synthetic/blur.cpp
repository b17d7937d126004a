#include <algorithm>
#include <cmath>
#include <vector>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/synthetic/detail/render.hpp"

namespace dynasurf::synthetic {
namespace {

/// Half of the discrete Gaussian exp(-t) I_n(t), n = 0, 1, ..., scaled to sum 1 over both sides. Computed by the
/// recurrence of the Bessel functions run downwards (Miller), which is stable.
std::vector<double> discrete_gaussian(double t) {
  const int reach = static_cast<int>(std::ceil(6 * std::sqrt(t))) + 3;
  const int top = reach + static_cast<int>(std::ceil(4 * std::sqrt(t))) + 20;
  std::vector<double> half(reach + 1, 0.0);
  double above = 0, here = 1e-280;  // orders n + 1 and n
  for (int n = top; n >= 0; --n) {
    if (n <= reach) half[n] = here;
    const double below = above + 2 * n / t * here;
    above = here;
    here = below;
    if (here > 1e200) {
      above *= 1e-200, here *= 1e-200;
      for (double& h : half) h *= 1e-200;
    }
  }
  double sum = -half[0];
  for (double h : half) sum += 2 * h;
  for (double& h : half) h /= sum;
  return half;
}

Image blur_axis(const Image& image, int axis, const std::vector<double>& half) {
  const Index3 dims = image.grid.dims;
  const int reach = static_cast<int>(half.size()) - 1;
  Image result(image.grid);
  parallel_for(dims[2], 1, [&](std::size_t begin, std::size_t end) {
    for (int k = static_cast<int>(begin); k < static_cast<int>(end); ++k)
      for (int j = 0; j < dims[1]; ++j)
        for (int i = 0; i < dims[0]; ++i) {
          double sum = half[0] * image(i, j, k);
          for (int n = 1; n <= reach; ++n) {
            const int a = axis == 0 ? n : 0, b = axis == 1 ? n : 0, c = axis == 2 ? n : 0;
            sum += half[n] * (static_cast<double>(image.clamped(i - a, j - b, k - c)) +
                              static_cast<double>(image.clamped(i + a, j + b, k + c)));
          }
          result(i, j, k) = static_cast<float>(sum);
        }
  });
  return result;
}

}  // namespace

Image blur(const Image& image, double fwhm_mm) {
  const double sigma = sigma_of_fwhm(fwhm_mm);
  // Below a hundredth of a voxel the kernel is a single 1 to float precision.
  Image result = image;
  for (int a = 0; a < 3; ++a) {
    const double sigma_voxels = sigma / image.grid.spacing[a];
    if (sigma_voxels > 0.01 && image.grid.dims[a] > 1)
      result = blur_axis(result, a, discrete_gaussian(sigma_voxels * sigma_voxels));
  }
  return result;
}

}  // namespace dynasurf::synthetic
