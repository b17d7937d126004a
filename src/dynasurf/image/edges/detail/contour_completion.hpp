#pragma once
#include "dynasurf/image/detail/slice.hpp"
#include "dynasurf/image/edges.hpp"

namespace dynasurf::image {

/// Heat that flows along contours only: u_t = div(D grad u), D = c xi xi^T, where xi is the common tangent of the
/// contours around a pixel and c how much they agree (EDGE-ACC). The tangents are those of the image itself, or of
/// the contour for the completion.
///
/// D is symmetric, and the divergence is the exact adjoint of the gradient: the sum of a slice does not change, no
/// step up to 0.25 px^2 can blow up. Scharr's differences keep the flow from leaking across slanted contours.
Slice diffuse_along_contours(const Slice& image, const ContourCompletion& options);

/// The completion: 1 on the contour at all times, 0 elsewhere at the start, heat along the contour's own tangents as
/// they extend beyond its ends.
Slice complete_contour(const Slice& contour, const ContourCompletion& options);

}  // namespace dynasurf::image
