#pragma once
#include <optional>
#include <span>
#include <vector>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::image {

/// Weights w[0..reach] of a Gaussian of standard deviation `sigma` steps, which sum to 1 over both sides; the other
/// half is the mirror image. Reach: ceil(3 sigma), unless given. sigma 0: {1}.
std::vector<double> half_gaussian(double sigma, std::optional<int> reach = {});

/// Convolution along one axis with a symmetric kernel; beyond the ends the outermost voxels are repeated. Sums run in
/// double over mirrored pairs, so a mirrored image gives the mirrored result to the bit.
Image convolve_along(const Image& image, std::span<const double> half_kernel, int axis);

}  // namespace dynasurf::image
