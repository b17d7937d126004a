#include <algorithm>
#include <cmath>
#include <vector>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/image/detail/gaussian.hpp"
#include "dynasurf/synthetic/detail/render.hpp"

namespace dynasurf::synthetic {
namespace {

/// Half of the discrete Gaussian exp(-t) I_n(t), n = 0, 1, ..., scaled to sum 1 over both sides. Computed by the
/// recurrence of the Bessel functions run downwards (Miller), which is stable.
std::vector<double> discrete_gaussian(double t) {
  const int reach = ceil_int(6 * std::sqrt(t)) + 3;
  const int top = reach + ceil_int(4 * std::sqrt(t)) + 20;
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

}  // namespace

Image blur(const Image& image, double fwhm_mm) {
  const double sigma = sigma_of_fwhm(fwhm_mm);
  // Below a hundredth of a voxel the kernel is a single 1 to float precision.
  Image result = image;
  for (int a = 0; a < 3; ++a) {
    const double sigma_voxels = sigma / image.grid.spacing[a];
    if (sigma_voxels > 0.01 && image.grid.dims[a] > 1)
      result = image::convolve_along(result, discrete_gaussian(sigma_voxels * sigma_voxels), a);
  }
  return result;
}

}  // namespace dynasurf::synthetic
