#include "dynasurf/ventricle/detail/border_planes.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/visit_marked.hpp"

namespace dynasurf::ventricle {
namespace {

/// Bilinear value in slice k, replicated outside.
double value_at(const Image& image, double x, double y, int k) {
  const int i = floor_int(x), j = floor_int(y);
  const double a = x - i, b = y - j;
  return (1 - a) * (1 - b) * image.clamped(i, j, k) + a * (1 - b) * image.clamped(i + 1, j, k) +
         (1 - a) * b * image.clamped(i, j + 1, k) + a * b * image.clamped(i + 1, j + 1, k);
}

/// Way from the middle sample to the vertex of the parabola through three samples one apart; within half a sample, 0
/// where there is no maximum.
double parabola_vertex(double before, double middle, double after) {
  const double curvature = before - 2 * middle + after;
  return curvature < 0 ? std::clamp(0.5 * (before - after) / curvature, -0.5, 0.5) : 0;
}

dynamics::BorderPlane plane_of(std::size_t voxel, const Vec3& offset_mm, const Vec3& normal) {
  return {voxel, offset_mm.cast<float>(), normal.cast<float>()};
}

/// The plane that an edge pixel has in the border volume's voxel.
dynamics::BorderPlane plane_of_edge(const Image& strength, const Axis& axis, const Index3& v, std::size_t voxel) {
  const int k = v[2];
  const double x = v[0] - axis.x_at(k), y = v[1] - axis.y_at(k), radius = own::hypot(x, y);
  if (radius == 0) return {.voxel = voxel};
  const double ux = x / radius, uy = y / radius;
  const double shift_px = parabola_vertex(value_at(strength, v[0] - ux, v[1] - uy, k), strength(v[0], v[1], k),
                                          value_at(strength, v[0] + ux, v[1] + uy, k));
  const Vec3& mm = strength.grid.spacing;
  return plane_of(voxel, {shift_px * ux * mm[0], shift_px * uy * mm[1], 0}, {ux / mm[0], uy / mm[1], 0});
}

}  // namespace

dynamics::BorderPlanes border_planes(const Image& border, Border wall, const Labels& labels,
                                     const image::EdgeMap& edges, int base_slice) {
  dynamics::BorderPlanes planes{border.grid, {}};
  const Grid& grid = labels.borders.grid;
  // The border's grid is the labels' grown by whole voxels; no voxel of the border lies in what was added.
  const Index3 shift = voxel_of(border.grid, to_grid(border.grid, grid.origin));
  const std::uint8_t bit = wall == Border::endo ? Labels::endo_bit : Labels::epi_bit;
  const double half_slice = grid.spacing[2] / 2;
  for (int k = 0; k < grid.dims[2]; ++k)
    visit_marked(border, k + shift[2], [&](int border_i, int border_j) {
      const int i = border_i - shift[0], j = border_j - shift[1];
      const std::size_t voxel = border.grid.index(border_i, border_j, k + shift[2]);
      const bool on_edge = (labels.borders(i, j, k) & bit) != 0;
      const double face = k == base_slice ? half_slice : -half_slice;
      planes.planes.push_back(on_edge ? plane_of_edge(edges.gradient, labels.axis, {i, j, k}, voxel)
                                      : plane_of(voxel, {0, 0, face}, {0, 0, 1}));
    });
  return planes;
}

}  // namespace dynasurf::ventricle
