#pragma once
#include "dynasurf/core/progress.hpp"
#include "dynasurf/core/study.hpp"
#include "dynasurf/psf_fit/detail/blur_options.hpp"
#include "dynasurf/psf_fit/detail/fit_start.hpp"
#include "dynasurf/psf_fit/detail/fitted_beat.hpp"

namespace dynasurf::psf_fit {

/// Fits the walls of all gates at once: two surfaces of one topology per gate, regional uptake between them, levels of
/// blood and surroundings and hot neighbours, seen through a Gaussian point spread and compared with the voxels as they
/// were stored. Shapes and motion are smooth and periodic, the muscle's volume is constant.
/// `start` needs both surfaces in all gates of `study`. Deterministic for any number of threads.
FittedBeat fit_through_blur(const Study& study, const FitStart& start, const BlurFit& options,
                            const Progress& progress = {});

}  // namespace dynasurf::psf_fit
