#pragma once
#include "dynasurf/psf_fit/detail/least_squares.hpp"

namespace dynasurf::psf_fit {

/// Variance, in squares of healthy muscle, of what every model of a ventricle leaves out.
inline constexpr double usual_misfit = 0.01 * 0.01;

/// Variances of a pixel of weight 1 times the number of pixels that share it.
struct PixelNoise {
  double of_steps = 0;     // noise, shared as far as it is seen; what the model leaves out, no farther than the blur
  double of_errors = 0;    // both shared as far as it is seen, of the misfit the part that every fit has
  double misfit_seen = 0;  // variance of a pixel of weight 1
};

/// From the residuals of the fit. Misfit is correlated over longer distances than noise; counted so far during the
/// steps it would let the priors win. Of the errors, what stands still beyond noise is no part: it is bias, not spread.
PixelNoise noise_of(const BeatProblem& problem, const Objective& objective);

}  // namespace dynasurf::psf_fit
