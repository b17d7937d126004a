#pragma once
#include <optional>
#include <vector>

#include "dynasurf/core/study.hpp"
#include "dynasurf/psf_fit/detail/fit_start.hpp"

namespace dynasurf::psf_fit {

/// Volumes by the construction of programs of the QGS family. Behind our blur its ejection fraction reads far too high,
/// which theirs does not: not to be mapped to their numbers.
struct GaussianProfile {
  std::vector<double> cavity_ml, wall_ml;  // per gate
};

/// Along rays from the middle of the cavity the brightest point is the middle of the wall; an asymmetric Gaussian is
/// laid through what lies on either side of it, and the walls are set at 65 % of its two standard deviations. That
/// share is then changed gate by gate until all gates hold the same muscle as in the mean of the beat. The base plane
/// closes both walls. After what was published of the method, not a copy of any program.
/// `start` needs both surfaces in all gates; it says where to look. Absent when the walls cannot be seen.
std::optional<GaussianProfile> read_gaussian_profile(const Study& study, const FitStart& start);

}  // namespace dynasurf::psf_fit
