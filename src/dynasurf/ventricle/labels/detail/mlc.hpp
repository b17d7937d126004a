#pragma once
#include "dynasurf/ventricle/labels/detail/circle.hpp"

namespace dynasurf::ventricle {

/// One pass of LAB-MLC (thesis 2.3.6) over the edges inside the automatic circle; returns Labels' bits per voxel.
/// Up to `division_slice` every edge is the outer border. Above it the edges of a slice are sorted by their mean
/// distance to the axis, and the largest gap divides inner from outer. A slice with one edge, or whose largest gap is
/// below `min_gap_px`, has fragments of one border: each goes to the wall whose median distance in the slices up to
/// three away is nearer, or is outer when those do not tell. With `strict_thesis` the largest gap always decides, and a
/// single edge is outer.
Mask classify_by_gap(const SliceEdges& edges, const Grid& grid, const Axis& axis, int division_slice,
                     const Mlc& options);

/// Edges cut where the wall changes sides. An image brightens outwards across the inner border of the wall and darkens
/// outwards across the outer one; the Sobel gradient of the image, summed over the neighbours on the edge, tells which.
/// Pixels whose gradient runs along the wall (the ends of an open wall, the sides of a defect) belong to neither.
struct SidedEdges {
  SliceEdges endo, epi;
};

/// Fragments with fewer than `min_px` pixels are dropped.
SidedEdges split_by_gradient(const SliceEdges& edges, const Image& image, const Axis& axis, int min_px);

/// Both lists in one.
SliceEdges join(const SidedEdges& edges);

/// The robust classification: each fragment goes to the side its gradient tells, but pixels are dropped that contradict
/// the borders in the same direction within two slices: inner ones outside the outer border (gut, right ventricle),
/// outer ones inside the inner border, and outer ones far outside the outer border. Returns Labels' bits in all slices,
/// whatever the division slice. "mlc.outliers" counts what was dropped.
Mask classify_by_gradient(const SidedEdges& edges, const Grid& grid, const Axis& axis, int min_px, Notes& notes);

/// Pixels of slice k that carry `bit`.
std::vector<image::Pixel> pixels_of(const Mask& borders, int k, std::uint8_t bit);

/// Number of borders in slice k: 0, 1 or 2. The inner one counts when it covers at least `least_coverage_deg` around
/// the axis.
int count_borders(const Mask& borders, int k, const Axis& axis, double least_coverage_deg);

}  // namespace dynasurf::ventricle
