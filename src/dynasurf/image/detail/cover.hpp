#pragma once
#include "dynasurf/core/volume.hpp"

namespace dynasurf::image {

/// VOL-COVER (thesis 6.1.2.1): a disc one slice thick in the slice above the highest occupied one, around the centroid
/// of that one. Empty when there is no occupied voxel or no slice above.
Mask cover_disc(const Mask& solid, double radius_mm);

/// Voxels set in either. Both have the same grid.
Mask unite(Mask a, const Mask& b);

}  // namespace dynasurf::image
