#pragma once
#include "dynasurf/core/grid.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/synthetic/options.hpp"
#include "dynasurf/synthetic/ventricle_shape.hpp"

// What real hearts and cameras have and the plain virtual patient has not. Internal.

namespace dynasurf::synthetic {

/// Factor by which a point of a smooth wall lies farther from the long axis: a septum that is flat, a bulge that winds
/// around, ridges. 1 on the axis at the apex. Frame of the heart.
double width_factor(const Irregularity& o, const Vec3& p, double base_z);
/// The same for the outer wall: thickness differs from place to place too.
double outer_width_factor(const Irregularity& o, const Vec3& p, double base_z);

/// A point moved by such a factor, and the point that was moved there.
inline Vec3 widened(const Vec3& p, double factor) { return {factor * p[0], factor * p[1], p[2]}; }
inline Vec3 narrowed(const Vec3& p, double factor) { return {p[0] / factor, p[1] / factor, p[2]}; }

/// True in one of two papillary muscles, which stand in the cavity along its wall. `p` as in the smooth heart.
bool in_papillary(const Irregularity& o, const VentricleShape& shape, const Vec3& p);

/// What a camera of width `fwhm_mm` with tails and a blur that grows with depth makes of an image that was blurred to
/// `narrow_fwhm_mm` only: rows (j) run from near to far.
Image see_unevenly(const Irregularity& o, const Image& narrow, double narrow_fwhm_mm, double fwhm_mm);
/// The width to render with before `see_unevenly`.
double narrow_fwhm(const Irregularity& o, double fwhm_mm);

}  // namespace dynasurf::synthetic
