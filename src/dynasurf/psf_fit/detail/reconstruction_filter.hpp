#pragma once
#include <optional>

#include "dynasurf/core/study.hpp"

namespace dynasurf::psf_fit {

/// A Butterworth filter, 1 / sqrt(1 + (f / cutoff)^(2 order)): what filtered backprojection leaves of every frequency.
/// Its edge is so steep that a wall gets a dark ring, which no Gaussian explains.
struct ReconstructionFilter {
  double cutoff_per_mm = 0.04;  // cycles per mm
  double order = 5;
};

/// The filter as the noise shows it; absent where a Gaussian explains the noise as well, and with fewer than six gates.
///
/// Noise enters a reconstruction white and leaves it with the filter's shape. Third differences over the gates are free
/// of what stands still or beats slowly; the logarithm of their power spectrum, mean over shells of |f|, is fitted by
/// a power of f (the ramp), a Gaussian and a Butterworth filter.
std::optional<ReconstructionFilter> filter_in_noise(const Study& study);

/// Standard deviation (mm) of the Gaussian filter that can take its place without amplifying any frequency by more than
/// a half.
double gaussian_in_place_of(const ReconstructionFilter& filter);

/// The study as if it had been reconstructed with a Gaussian filter of this deviation, within the box; its values are
/// continued beyond the box by those at its rim.
Study with_gaussian_filter(const Study& study, const ReconstructionFilter& filter, double sigma_mm,
                           const VoxelBox& box);

}  // namespace dynasurf::psf_fit
