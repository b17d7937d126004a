#pragma once
#include "dynasurf/psf_fit/detail/fitted_beat.hpp"
#include "dynasurf/psf_fit/detail/least_squares.hpp"

namespace dynasurf::psf_fit {

/// Turns a solution into surfaces, volumes and their error bars. `usual_share` of the muscle along every ray, or less
/// (papillary_share.hpp), counts as cavity. `noise`: as in BeatProblem, of the errors alone. Internal.
void describe_beat(const BeatProblem& problem, const Solution& solution, double noise, const Grid& grid,
                   double usual_share, FittedBeat& beat);

}  // namespace dynasurf::psf_fit
