#pragma once
// A ventricle as an emission camera sees it: half an ellipsoidal shell, open at the base, blurred and noisy. Small and
// independent of the library's own phantoms, so that the two check each other.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::test {

struct Blob {  // activity of the gut: a ball
  double x_px, y_px, slice, radius_mm, intensity;
};

struct HeartShape {
  Index3 dims{64, 64, 23};
  Vec3 spacing{2.87, 2.87, 5.74};
  double x_px = 31.5, y_px = 31.5, tilt_x_px = 0, tilt_y_px = 0;  // centre in the middle slice, drift per slice
  double apex_slice = 4, base_slice = 18;                         // outer apex, base plane
  double epi_radius_mm = 36, wall_mm = 10, apex_wall_mm = 9;
  double fwhm_mm = 12, noise = 0, background = 0.07;  // noise: standard deviation, of the maximum
  unsigned seed = 1;
  double defect_deg = 0, defect_from_slice = 0, defect_to_slice = 100;  // sector around +x without activity
  std::vector<Blob> blobs{};
};

/// Radius of the outer (or inner) border in slice k before blurring; 0 where there is none.
inline double true_radius_px(const HeartShape& h, double k, bool epi) {
  const double half_length = (h.base_slice - h.apex_slice) * h.spacing[2], z = (h.base_slice - k) * h.spacing[2];
  const double a = h.epi_radius_mm - (epi ? 0 : h.wall_mm), c = half_length - (epi ? 0 : h.apex_wall_mm);
  if (z < 0 || z >= c) return 0;
  return a * std::sqrt(1 - z * z / (c * c)) / h.spacing[0];
}

inline double centre_x(const HeartShape& h, double k) { return h.x_px + h.tilt_x_px * (k - h.dims[2] / 2); }
inline double centre_y(const HeartShape& h, double k) { return h.y_px + h.tilt_y_px * (k - h.dims[2] / 2); }

/// Separable Gaussian along one axis, borders replicated.
inline void blur(Image& m, int axis, double sigma_voxels) {
  if (sigma_voxels <= 0) return;
  const int radius = static_cast<int>(std::ceil(3 * sigma_voxels));
  Image out(m.grid);
  for (int k = 0; k < m.grid.dims[2]; ++k)
    for (int j = 0; j < m.grid.dims[1]; ++j)
      for (int i = 0; i < m.grid.dims[0]; ++i) {
        double sum = 0, weights = 0;
        for (int r = -radius; r <= radius; ++r) {
          const double w = std::exp(-r * r / (2 * sigma_voxels * sigma_voxels));
          sum += w * m.clamped(i + (axis == 0) * r, j + (axis == 1) * r, k + (axis == 2) * r);
          weights += w;
        }
        out(i, j, k) = static_cast<float>(sum / weights);
      }
  m = std::move(out);
}

inline Image blurred_heart(const HeartShape& h) {
  Grid grid;
  grid.dims = h.dims;
  grid.spacing = h.spacing;
  Image m(grid);
  constexpr int sub = 3;  // sub-samples along each side of a voxel
  const auto activity = [&](double i, double j, double k) {
    for (const Blob& b : h.blobs) {
      const double d =
          std::hypot((i - b.x_px) * h.spacing[0], (j - b.y_px) * h.spacing[1], (k - b.slice) * h.spacing[2]);
      if (d < b.radius_mm) return b.intensity;
    }
    const double dx = i - centre_x(h, k), dy = j - centre_y(h, k), d = std::hypot(dx, dy);
    const bool in_wall = d < true_radius_px(h, k, true) && d >= true_radius_px(h, k, false);
    const bool in_defect = std::abs(std::atan2(dy, dx)) * 360 / std::numbers::pi < h.defect_deg &&
                           k >= h.defect_from_slice && k <= h.defect_to_slice;
    return in_wall && !in_defect ? 1.0 : h.background;
  };
  for (int k = 0; k < h.dims[2]; ++k)
    for (int j = 0; j < h.dims[1]; ++j)
      for (int i = 0; i < h.dims[0]; ++i) {
        double sum = 0;
        for (int n = 0; n < sub * sub * sub; ++n) {
          const auto at = [&](int step) { return (n / step % sub + 0.5) / sub - 0.5; };
          sum += activity(i + at(1), j + at(sub), k + at(sub * sub));
        }
        m(i, j, k) = static_cast<float>(sum / (sub * sub * sub));
      }
  const double sigma_mm = h.fwhm_mm / std::sqrt(8 * std::numbers::ln2);
  for (int axis = 0; axis < 3; ++axis) blur(m, axis, sigma_mm / h.spacing[axis]);

  if (h.noise > 0) {  // correlated like that of a filtered reconstruction, about 1.7 px FWHM
    Image noise(grid);
    std::mt19937_64 random(h.seed);
    const auto uniform = [&] { return (static_cast<double>(random() >> 11) + 0.5) / 9007199254740992.0; };
    for (float& v : noise.values)
      v = static_cast<float>(std::sqrt(-2 * std::log(uniform())) * std::cos(2 * std::numbers::pi * uniform()));
    for (int axis = 0; axis < 3; ++axis) blur(noise, axis, axis == 2 ? 0.35 : 0.7);
    double square = 0;
    for (const float v : noise.values) square += v * v;
    const double scale = h.noise / std::sqrt(square / static_cast<double>(noise.values.size()));
    const float max = *std::max_element(m.values.begin(), m.values.end());
    for (std::size_t n = 0; n < m.values.size(); ++n) {
      // Counting noise: its variance grows with the activity.
      const double local = std::sqrt(std::max(0.05F, m.values[n] / max));
      m.values[n] = std::max(0.0F, m.values[n] + static_cast<float>(scale * max * local) * noise.values[n]);
    }
  }
  const float max = *std::max_element(m.values.begin(), m.values.end());
  for (float& v : m.values) v /= max;
  return m;
}

/// A quarter turn of every slice: (i, j) goes to (height - 1 - j, i).
template <class T>
Volume<T> quarter_turn(const Volume<T>& m) {
  Grid g = m.grid;
  std::swap(g.dims[0], g.dims[1]);
  Volume<T> out(g);
  for (int k = 0; k < m.grid.dims[2]; ++k)
    for (int j = 0; j < m.grid.dims[1]; ++j)
      for (int i = 0; i < m.grid.dims[0]; ++i) out(m.grid.dims[1] - 1 - j, i, k) = m(i, j, k);
  return out;
}

/// Moved by whole pixels within the slices; what comes in is a copy of the nearest pixel.
template <class T>
Volume<T> shifted(const Volume<T>& m, int di, int dj) {
  Volume<T> out(m.grid);
  for (int k = 0; k < m.grid.dims[2]; ++k)
    for (int j = 0; j < m.grid.dims[1]; ++j)
      for (int i = 0; i < m.grid.dims[0]; ++i) out(i, j, k) = m.clamped(i - di, j - dj, k);
  return out;
}

}  // namespace dynasurf::test
