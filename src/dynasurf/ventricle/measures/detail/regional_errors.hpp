#pragma once
#include "dynasurf/psf_fit/detail/wall_posterior.hpp"
#include "dynasurf/ventricle/measures/measures.hpp"

namespace dynasurf::ventricle {

/// Gives the numbers of every segment, and the spread of the onsets, the standard deviations that follow from how sure
/// the fit is of its walls. `measures` are those of the fitted walls. What is read from the image's counts, and a phase
/// of a segment that hardly moves, gets none.
void add_error_bars(Measures& measures, const psf_fit::WallPosterior& posterior);

}  // namespace dynasurf::ventricle
