#pragma once
#include <limits>
#include <vector>

#include "dynasurf/core/study.hpp"
#include "dynasurf/psf_fit/detail/blur_options.hpp"
#include "dynasurf/psf_fit/detail/least_squares.hpp"
#include "dynasurf/psf_fit/detail/start.hpp"

namespace dynasurf::psf_fit {

inline constexpr double sigmas_per_fwhm = 2.3548200450309493;

/// The assumed point spread: width (mm, FWHM) and its relative standard deviation.
struct Blur {
  double fwhm_mm = 0, uncertainty = 0;
  double filtered = 0.5;  // share of its variance that a filter on the voxels makes
};

/// Where a pixel lies against the wall at the start.
struct Place {
  double outside_mm = 0, above_mm = 0, depth = 0;  // depth: q over that of the outer wall
};

/// Of points, in the grid frame.
struct Bounds {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;
};

Bounds bounds_of(const std::vector<TriMesh>& meshes);

/// What a fit is prepared from, before any number of the model is known.
struct Setup {
  BeatProblem problem;
  std::vector<Place> place;
  double unit = 1;     // image value of activity 1
  double healthy = 1;  // of muscle in the blurred image
  double background = 0, cavity = 0;
  double highest_mm = 0;
};

/// Pixels, cells, places and levels of a study around the heart that was found in it.
Setup set_up(const Study& study, const PlacedStart& start, const Blur& blur, const BlurFit& options);

}  // namespace dynasurf::psf_fit
