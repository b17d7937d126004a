#pragma once
#include <cstddef>

#include "dynasurf/core/volume.hpp"
#include "dynasurf/image/detail/cover.hpp"

namespace dynasurf::synthetic {

// What the *voxels* of a phantom hold, as opposed to its analytic shape: the thesis measures its reconstructions
// against these (6.1.2.5), because blur and the 20 % cut make the data larger than the phantom.

/// Voxels at or above `fraction` of the maximum, and those they enclose within a slice: the external solid of the data.
Mask filled_solid(const Image& image, double fraction = 0.2);

/// Voxels below `fraction` of the maximum that the others enclose within their slice: the cavity of the data.
Mask enclosed_cavity(const Image& image, double fraction = 0.2);

/// Voxels of a solid that have a face neighbour outside it, as 1 in an image of 0: a border volume (VOL-BORDERS). The
/// edge of the grid counts as inside.
Image surface_voxels(const Mask& solid);

/// Surface of the filled external solid; `cover_radius_mm` > 0 closes its top by a cover first.
Image external_border(const Image& image, double fraction = 0.2, double cover_radius_mm = 0);
/// Surface of the enclosed cavity.
Image internal_border(const Image& image, double fraction = 0.2);

std::size_t count_voxels(const Mask& mask);
/// Voxels times the volume of one.
double voxel_volume_ml(const Mask& mask);

}  // namespace dynasurf::synthetic
