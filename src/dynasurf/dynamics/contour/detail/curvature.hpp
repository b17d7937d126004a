#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "dynasurf/core/contour.hpp"

namespace dynasurf::dynamics {

/// The local frame of a contour (INT-CURV, thesis 3.2.4, eqs 3.10-3.17), per point.
struct CurvatureFrame {
  std::vector<Vec2> radial;  // unit vectors square to the tangent; outwards on a counter-clockwise contour
  std::vector<double> k;     // change of direction along `radial`: depends on angles alone, negative where convex
};
/// Where the direction reverses, the radial vector of the point before is taken; edges without length are passed over.
/// The ends of an open contour have the direction of their edge and k = 0.
CurvatureFrame curvature_frame(const Contour& contour);

/// `fixed`: the published filter {-1/2, 1, -1/2} over neighbours. `adaptive` (FUT-CURVFILTER): the same idea over
/// arc length: curvature per length against its mean over all points within 1.5 mean edges, so that unequal edges do
/// not look like curvature. On equal edges both are the same.
enum class CurvatureFilter { fixed, adaptive };
std::span<const std::string_view> names_of(CurvatureFilter);

/// The internal force (eqs 3.18, 3.19): the filtered curvature along `radial`. Zero for constant curvature, whatever
/// its size; independent of the sense in which the contour is run through.
std::vector<Vec2> curvature_force(const Contour& contour, const CurvatureFrame& frame,
                                  CurvatureFilter filter = CurvatureFilter::fixed);

}  // namespace dynasurf::dynamics
