#pragma once
#include "dynasurf/image/detail/slice.hpp"
#include "dynasurf/image/edges.hpp"
#include "dynasurf/image/edges/detail/contour_prior.hpp"

namespace dynasurf::image {

/// Heat that flows along contours only: u_t = div(D grad u), D = c xi xi^T, where xi is the common tangent of the
/// contours around a pixel and c how much they agree (EDGE-ACC). The tangents are those of the image itself, or of
/// the contour for the completion.
///
/// D is symmetric, and the divergence is the exact adjoint of the gradient: the sum of a slice does not change, no
/// step up to 0.25 px^2 can blow up. Scharr's differences keep the flow from leaking across slanted contours.
/// A prior (FUT-ACC) mixes the tangents of its circles or ellipses into those that were seen.
Slice diffuse_along_contours(const Slice& image, const ContourCompletion& options,
                             const std::optional<Conic>& prior = {});

/// The completion: 1 on the contour at all times, 0 elsewhere at the start, heat along the contour's own tangents as
/// they extend beyond its ends on the circles that they belong to (co-circular votes of Parent and Zucker 1989, Guy and
/// Medioni 1996).
struct CompletedContour {
  Slice heat;
  SliceVectors normal;  // across the extended contours
  Slice strength;       // of what speaks for them: highest where they run
};
CompletedContour complete_contour(const Slice& contour, const ContourCompletion& options,
                                  const std::optional<Conic>& prior = {});

}  // namespace dynasurf::image
