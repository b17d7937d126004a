#pragma once
#include "dynasurf/psf_fit/detail/cholesky.hpp"
#include "dynasurf/psf_fit/detail/least_squares.hpp"

namespace dynasurf::psf_fit {

/// Part of the muscle that stands in the cavity as papillary muscles, 0 to `usual`. Two columns leave two bulges on the
/// inner wall; where the time's mean of that wall is more even than `usual` ones would make it, error bars included, it
/// is as much less than `usual`. `factor`: of the normal matrix at `unknowns`.
double papillary_share(const BeatProblem& problem, const Solution& solution, const Cholesky& factor, double usual);

}  // namespace dynasurf::psf_fit
