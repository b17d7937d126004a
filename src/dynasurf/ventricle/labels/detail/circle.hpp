#pragma once
#include <optional>
#include <vector>

#include "dynasurf/image/detail/components.hpp"
#include "dynasurf/ventricle/labels.hpp"

namespace dynasurf::ventricle {

/// The edges of every slice: `edges[k]` are the components of slice k.
using SliceEdges = std::vector<std::vector<image::Component>>;

/// LAB-COMP (thesis 2.3.6): the 8-connected edges of every slice but those with fewer than `min_px` pixels.
SliceEdges find_components(const Mask& edges, int min_px);

/// The same as a mask.
Mask to_mask(const SliceEdges& edges, const Grid& grid);

/// CIRC-COARSE (thesis 2.4): the circle of `options`, its unset parts filled in for `grid`.
Circle coarse_circle(const Grid& grid, const CoarseCircle& options);

/// Edges with everything farther than `radius_px` from the axis set to 0, pixel by pixel.
Mask clip(Mask edges, const Axis& axis, double radius_px);

/// Least-squares circle through pixels (Kasa: algebraic distance). Empty for fewer than three or collinear pixels.
std::optional<Circle> fit_circle(const std::vector<image::Pixel>& pixels);

/// Angle seen from (x, y) that the pixels cover: 360 less the widest empty sector; 0 for fewer than two pixels.
double coverage_deg(const std::vector<image::Pixel>& pixels, double x_px, double y_px);

/// CIRC-CENTROID (thesis 2.4.1).
struct Centre {
  double x_px = 0, y_px = 0;                 // common to all slices
  std::vector<std::optional<Circle>> local;  // per slice: the largest circular edge
};

/// The centre of the ventricle: the mean of the centres of the largest circular edge of each slice, weighted by their
/// nearness to the image centre. An edge is circular when a share of more than `centroid_share` of its pixels lies
/// within the tolerance of one distance from its own centre: its centroid, or with `robust_fit` the centre of the
/// fitted circle, which must then see at least 180 degrees of it. Without any circular edge the centre is the centroid
/// of the intensities of the image ("circle.no_circular_edge"); of an image without any, its middle.
Centre find_centre(const SliceEdges& edges, const Image& image, const AutoCircle& options, Notes& notes);

/// The long axis. With `robust_fit` a line through the local centres by median slopes, which a third of wrong centres
/// does not move; it needs local centres in at least five slices. Otherwise the common centre in all slices.
Axis find_axis(const Centre& centre, const AutoCircle& options);

/// CIRC-RADIUS (thesis 2.4.2).
struct WidestEdge {
  double radius_px = 0;  // without the offset; 0: none found
  int slice = -1;        // the "big slice"; -1: none found
};

/// The widest edge that is circular around the axis, its distance weighted by nearness to the image centre. With
/// `robust_fit` it must also cover at least 180 degrees. "circle.no_wide_edge" when none qualifies.
WidestEdge find_widest_edge(const SliceEdges& edges, const Grid& grid, const Axis& axis, const AutoCircle& options,
                            Notes& notes);

}  // namespace dynasurf::ventricle
