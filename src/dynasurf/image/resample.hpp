#pragma once
#include "dynasurf/core/volume.hpp"

namespace dynasurf::image {

/// Value at a point of the grid frame (mm) by linear interpolation. Outside the grid the nearest value inside stands.
double sample_linear(const Image& image, const Vec3& grid_mm);

/// The same by cubic interpolation (Keys, a = -1/2): exact for parabolas, so it does not blur as linear does.
double sample_cubic(const Image& image, const Vec3& grid_mm);

/// The image at the voxels of another grid, by one cubic interpolation; 0 where a voxel lies more than half a voxel
/// outside `image`. A non-negative image stays non-negative: overshoot below 0 is cut.
/// Both grids are placed in the world. Structures finer than the new voxels are not filtered out.
Image resample(const Image& image, const Grid& grid);

/// Gaussian of standard deviation `sigma_mm` along every axis, borders replicated; 0 returns the image.
Image smooth_gaussian(const Image& image, double sigma_mm);

}  // namespace dynasurf::image
