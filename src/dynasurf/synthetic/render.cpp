#include "dynasurf/synthetic/detail/render.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::synthetic {
namespace {

/// Sub-samples along one axis and what each voxel collects of them.
struct Axis {
  int voxels = 0;
  int first = 0;              // index of the first sub-sample; sub-sample f of voxel 0 is f in [0, per_voxel)
  int count = 0;              // sub-samples that may hold activity
  double step = 1;            // mm between them
  double start = 0;           // position of the first, mm
  std::vector<int> from, to;  // per voxel: range of sub-samples [from, to)
  std::vector<std::vector<double>> weights;  // per voxel, one per sub-sample of the range
};

int per_voxel(double spacing, double sigma, int asked) {
  // A Gaussian sampled at steps up to its sigma sums to 1 within 1e-8, which is what makes its width exact.
  return sigma > 0 ? std::max(asked, ceil_int(spacing / sigma)) : asked;
}

/// A sample stands for its whole sub-cell, which spreads it already; the Gaussian does the rest.
double spread_without_cell(double sigma, double step) { return std::sqrt(sigma * sigma - step * step / 12); }

double gaussian(double x, double sigma) {
  return own::exp(-x * x / (2 * sigma * sigma)) / (sigma * std::sqrt(2 * M_PI));
}

/// Where in its sub-cell a sample is taken along one axis (-0.5..0.5), from its indices along the other two. Samples
/// at the centres would all fall on the same side of a flat face that runs along the grid; these, points of a lattice
/// of low discrepancy (the R2 sequence), fall on both sides in the right proportion.
double place_in_cell(int a, int b) {
  const double x = a * 0.7548776662466927 + b * 0.5698402909980532;
  return x - std::floor(x) - 0.5;
}

Axis make_axis(int voxels, double spacing, double low, double high, double sigma, int asked) {
  constexpr double reach_sigmas = 5;
  const int n = per_voxel(spacing, sigma, asked);
  Axis axis;
  axis.voxels = voxels;
  axis.step = spacing / n;
  const double cells_low = (low + spacing / 2) / axis.step, cells_high = (high + spacing / 2) / axis.step;
  const double margin = reach_sigmas * sigma / axis.step + 1;
  axis.first = floor_int(std::max(cells_low, -margin));
  const int end = ceil_int(std::min(cells_high, voxels * n + margin));
  axis.count = std::max(0, end - axis.first);
  axis.start = (axis.first + 0.5) * axis.step - spacing / 2;
  axis.from.resize(voxels);
  axis.to.resize(voxels);
  axis.weights.resize(voxels);
  for (int i = 0; i < voxels; ++i) {
    const double centre = i * spacing;
    const double reach = sigma > 0 ? reach_sigmas * sigma : spacing / 2;
    const int from = ceil_int((centre - reach - axis.start) / axis.step - 1e-9);
    const int to = floor_int((centre + reach - axis.start) / axis.step + 1e-9) + 1;
    axis.from[i] = std::clamp(from, 0, axis.count);
    axis.to[i] = std::clamp(to, axis.from[i], axis.count);
    for (int f = axis.from[i]; f < axis.to[i]; ++f) {
      const double x = axis.start + f * axis.step - centre;
      axis.weights[i].push_back(sigma > 0 ? axis.step * gaussian(x, spread_without_cell(sigma, axis.step)) : 1.0 / n);
    }
  }
  return axis;
}

/// Plane `h` of sub-samples gathered into voxels along i and j: a row of voxels per j.
std::vector<double> gather_plane(const Axis& x, const Axis& y, const Axis& z, int h, const Density& density) {
  const Index width = x.voxels;
  std::vector<double> rows(width * y.count, 0.0), samples(x.count);
  for (int g = 0; g < y.count; ++g) {
    bool any = false;
    const int row = y.first + g, layer = z.first + h;
    const double in_cell_x = place_in_cell(row, layer);
    for (int f = 0; f < x.count; ++f) {
      const int column = x.first + f;
      samples[f] = density({x.start + (f + in_cell_x) * x.step, y.start + (g + place_in_cell(layer, column)) * y.step,
                            z.start + (h + place_in_cell(column, row)) * z.step});
      any = any || samples[f] != 0;
    }
    if (!any) continue;
    for (int i = 0; i < x.voxels; ++i) {
      double sum = 0;
      for (int f = x.from[i]; f < x.to[i]; ++f) sum += x.weights[i][f - x.from[i]] * samples[f];
      rows[width * g + i] = sum;
    }
  }
  std::vector<double> plane(width * y.voxels, 0.0);
  for (int j = 0; j < y.voxels; ++j)
    for (int g = y.from[j]; g < y.to[j]; ++g) {
      const double w = y.weights[j][g - y.from[j]];
      for (int i = 0; i < width; ++i) plane[width * j + i] += w * rows[width * g + i];
    }
  return plane;
}

}  // namespace

Index3 sub_samples_for(const Grid& grid, double step_mm, int least) {
  Index3 n;
  for (int a = 0; a < 3; ++a) n[a] = std::max(least, ceil_int(grid.spacing[a] / step_mm - 1e-9));
  return n;
}

Image render(const Grid& grid, const Density& density, const Box& support, double fwhm_mm, const Index3& sub_samples) {
  const double sigma = sigma_of_fwhm(fwhm_mm);
  Axis axes[3];
  for (int a = 0; a < 3; ++a)
    axes[a] = make_axis(grid.dims[a], grid.spacing[a], support.low[a], support.high[a], sigma, sub_samples[a]);
  const Axis &x = axes[0], &y = axes[1], &z = axes[2];

  std::vector<std::vector<double>> planes(z.count);
  parallel_for(planes.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t h = begin; h < end; ++h) planes[h] = gather_plane(x, y, z, h, density);
  });

  Image image(grid);
  const std::size_t slice = grid.slice_size();
  parallel_for(grid.dims[2], 1, [&](std::size_t begin, std::size_t end) {
    std::vector<double> sum(slice);
    for (std::size_t k = begin; k < end; ++k) {
      std::fill(sum.begin(), sum.end(), 0.0);
      for (int h = z.from[k]; h < z.to[k]; ++h) {
        const double w = z.weights[k][h - z.from[k]];
        for (std::size_t v = 0; v < slice; ++v) sum[v] += w * planes[h][v];
      }
      for (std::size_t v = 0; v < slice; ++v) image.values[k * slice + v] = sum[v];
    }
  });
  return image;
}

}  // namespace dynasurf::synthetic
