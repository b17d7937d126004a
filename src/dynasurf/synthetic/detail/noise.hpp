#pragma once
#include <cstdint>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::synthetic {

/// Draws each voxel from a Poisson law whose mean is its value (values below 0 count as 0). `stream` separates the
/// gates of one study. The result depends on seed, stream and position of the voxel only.
Image draw_counts(const Image& mean_counts, std::uint64_t seed, std::uint64_t stream);

/// Adds a normal deviate of standard deviation `sd` to each voxel, independent between voxels.
Image add_gaussian_noise(Image image, double sd, std::uint64_t seed, std::uint64_t stream);

}  // namespace dynasurf::synthetic
