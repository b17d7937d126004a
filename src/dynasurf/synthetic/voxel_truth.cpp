#include "dynasurf/synthetic/detail/voxel_truth.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace dynasurf::synthetic {
namespace {

/// Above 0 in any case: in an empty image the level is 0, and nothing is wall.
Mask reach_level(const Image& image, double fraction) {
  Mask mask(image.grid);
  if (image.values.empty()) return mask;
  const double level = fraction * *std::max_element(image.values.begin(), image.values.end());
  for (std::size_t v = 0; v < mask.values.size(); ++v) mask.values[v] = image.values[v] > 0 && image.values[v] >= level;
  return mask;
}

/// Marks the empty voxels of slice k that the edge of the slice cannot reach through faces.
void mark_enclosed(const Mask& mask, int k, Mask& enclosed) {
  const int nx = mask.grid.dims[0], ny = mask.grid.dims[1];
  std::vector<std::pair<int, int>> open;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) enclosed(i, j, k) = mask(i, j, k) == 0;
  const auto visit = [&](int i, int j) {
    if (i < 0 || j < 0 || i >= nx || j >= ny || enclosed(i, j, k) == 0) return;
    enclosed(i, j, k) = 0;
    open.emplace_back(i, j);
  };
  for (int i = 0; i < nx; ++i) visit(i, 0), visit(i, ny - 1);
  for (int j = 0; j < ny; ++j) visit(0, j), visit(nx - 1, j);
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    visit(i - 1, j), visit(i + 1, j), visit(i, j - 1), visit(i, j + 1);
  }
}

}  // namespace

Mask enclosed_cavity(const Image& image, double fraction) {
  const Mask wall = reach_level(image, fraction);
  Mask enclosed(image.grid);
  for (int k = 0; k < image.grid.dims[2]; ++k) mark_enclosed(wall, k, enclosed);
  return enclosed;
}

Mask filled_solid(const Image& image, double fraction) {
  return image::unite(reach_level(image, fraction), enclosed_cavity(image, fraction));
}

Image surface_voxels(const Mask& solid) {
  Image border(solid.grid);
  for (int k = 0; k < solid.grid.dims[2]; ++k)
    for (int j = 0; j < solid.grid.dims[1]; ++j)
      for (int i = 0; i < solid.grid.dims[0]; ++i) {
        if (solid(i, j, k) == 0) continue;
        const bool inside = solid.clamped(i - 1, j, k) && solid.clamped(i + 1, j, k) && solid.clamped(i, j - 1, k) &&
                            solid.clamped(i, j + 1, k) && solid.clamped(i, j, k - 1) && solid.clamped(i, j, k + 1);
        border(i, j, k) = inside ? 0.0f : 1.0f;
      }
  return border;
}

Image external_border(const Image& image, double fraction, double cover_radius_mm) {
  Mask solid = filled_solid(image, fraction);
  if (cover_radius_mm > 0) solid = image::unite(solid, image::cover_disc(solid, cover_radius_mm));
  return surface_voxels(solid);
}

Image internal_border(const Image& image, double fraction) { return surface_voxels(enclosed_cavity(image, fraction)); }

std::size_t count_voxels(const Mask& mask) {
  return std::count_if(mask.values.begin(), mask.values.end(), [](auto v) { return v != 0; });
}

double voxel_volume_ml(const Mask& mask) { return count_voxels(mask) * mask.grid.voxel_volume_mm3() / 1000; }

}  // namespace dynasurf::synthetic
