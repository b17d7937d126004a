#pragma once
#include "dynasurf/core/volume.hpp"

namespace dynasurf::field::detail {

/// Throws InputError unless the map has voxels, a value for each, and a spacing.
void check_grid(const Image& edge_map);

/// Throws InputError unless the map has voxels, all finite, and a gradient whose square fits a float.
void check_edge_map(const Image& edge_map);

/// Slope of one row at position i of `count` along an axis, in units of the map per mm: central inside, one-sided on
/// the two ends, where a replicated neighbour would halve the slope of a straight ramp.
inline double slope(double before, double after, int i, int count, double spacing) {
  if (count < 2) return 0;
  return (after - before) / (i == 0 || i == count - 1 ? spacing : 2 * spacing);
}

/// Gradient of the map at voxel (i,j,k) along the grid's axes, per mm.
inline Vec3 gradient_at(const Image& f, int i, int j, int k) {
  const Index3& n = f.grid.dims;
  const Vec3& d = f.grid.spacing;
  return {slope(f.clamped(i - 1, j, k), f.clamped(i + 1, j, k), i, n[0], d[0]),
          slope(f.clamped(i, j - 1, k), f.clamped(i, j + 1, k), j, n[1], d[1]),
          slope(f.clamped(i, j, k - 1), f.clamped(i, j, k + 1), k, n[2], d[2])};
}

/// Largest squared length of the gradient, per mm squared.
double largest_gradient_squared(const Image& edge_map);

}  // namespace dynasurf::field::detail
