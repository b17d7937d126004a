#include "dynasurf/image/detail/gaussian.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/simd.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::image {
namespace {

/// A row of voxels, with `reach` of the outermost ones repeated on both sides.
void pad_row(const float* row, int width, int reach, std::vector<float>& padded) {
  std::fill_n(padded.begin(), reach, row[0]);
  std::copy_n(row, width, padded.begin() + reach);
  std::fill_n(padded.begin() + reach + width, reach, row[width - 1]);
}

/// The rows n before and after row (j, k) along `axis`.
std::array<const float*, 2> rows_beside(const Image& image, int axis, int j, int k, int n) {
  const Index3& dims = image.grid.dims;
  const auto row = [&](int step) {
    const int other_j = axis == 1 ? std::clamp(j + step, 0, dims[1] - 1) : j;
    const int other_k = axis == 2 ? std::clamp(k + step, 0, dims[2] - 1) : k;
    return image.values.data() + image.grid.index(0, other_j, other_k);
  };
  return {row(-n), row(n)};
}

}  // namespace

std::vector<double> half_gaussian(double sigma, std::optional<int> reach) {
  const int last = reach ? *reach : ceil_int(3 * sigma);
  std::vector<double> half{1.0};
  double sum = 1;
  for (int n = 1; n <= last; ++n) {
    half.push_back(own::exp(-n * n / (2 * sigma * sigma)));
    sum += 2 * half.back();
  }
  for (double& w : half) w /= sum;
  return half;
}

namespace {

/// sum[i] += weight (low[i] + high[i])
DYNASURF_CLONES
void add_pair(double* __restrict sum, const float* __restrict low, const float* __restrict high, double weight,
              int width) {
  for (int i = 0; i < width; ++i) sum[i] += weight * (double{low[i]} + double{high[i]});
}

}  // namespace

// A whole row per pair of taps: the inner loops run over neighbours in memory.
Image convolve_along(const Image& image, std::span<const double> half, int axis) {
  const Index3 dims = image.grid.dims;
  const int width = dims[0], reach = std::ssize(half) - 1;
  Image result(image.grid);
  if (result.values.empty()) return result;
  parallel_for(dims[2], 1, [&](int begin, int end) {
    std::vector<double> sum(width);
    std::vector<float> padded(axis == 0 ? width + 2 * reach : 0);
    for (int k = begin; k < end; ++k)
      for (int j = 0; j < dims[1]; ++j) {
        const float* row = image.values.data() + image.grid.index(0, j, k);
        for (int i = 0; i < width; ++i) sum[i] = half[0] * row[i];
        if (axis == 0) pad_row(row, width, reach, padded);
        for (int n = 1; n <= reach; ++n) {
          const auto [low, high] = axis == 0 ? std::array<const float*, 2>{&padded[reach - n], &padded[reach + n]}
                                             : rows_beside(image, axis, j, k, n);
          add_pair(sum.data(), low, high, half[n], width);
        }
        float* out = result.values.data() + result.grid.index(0, j, k);
        for (int i = 0; i < width; ++i) out[i] = sum[i];
      }
  });
  return result;
}

}  // namespace dynasurf::image
