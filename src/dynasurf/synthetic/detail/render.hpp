#pragma once
#include <functional>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::synthetic {

/// Activity per unit volume at a point of the grid frame (mm). Must be callable from several threads.
using Density = std::function<double(const Vec3&)>;

/// A box of the grid frame, mm.
struct Box {
  Vec3 low{0, 0, 0}, high{0, 0, 0};
};

/// Sub-samples per voxel along each axis that keep their distance at `step_mm` or below, at least `least` of them.
Index3 sub_samples_for(const Grid& grid, double step_mm, int least = 3);

/// What a camera with a Gaussian point spread function of full width at half maximum `fwhm_mm` sees of `density`: the
/// convolution of the two at the centre of each voxel. With `fwhm_mm` = 0 it is the mean over the cell of the voxel
/// (partial volume). `support` must hold all points where the density is not 0; it may reach beyond the grid.
/// The density is taken once in each of `sub_samples` sub-cells per voxel (more where the point spread is narrower than
/// a sub-cell), so the width in the image is the width asked for, whatever the voxels are.
Image render(const Grid& grid, const Density& density, const Box& support, double fwhm_mm, const Index3& sub_samples);

/// Convolves an image with a Gaussian of the given width, borders replicated. The kernel is the discrete Gaussian
/// exp(-t) I_n(t), whose variance is exact even where it is narrower than a voxel.
Image blur(const Image& image, double fwhm_mm);

/// Standard deviation of a Gaussian of the given full width at half maximum.
inline double sigma_of_fwhm(double fwhm) { return fwhm / 2.3548200450309493; }
inline double fwhm_of_sigma(double sigma) { return sigma * 2.3548200450309493; }

}  // namespace dynasurf::synthetic
