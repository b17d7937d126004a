#pragma once
#include <optional>

#include "dynasurf/core/detail/stage_clock.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/result.hpp"

namespace dynasurf::ventricle {

/// Volumes and ejection fraction of the edge surfaces, where all gates have them: `readings.edge`.
void measure_cycle(Result& result);

/// Readings beside the edge's.
struct OtherReadings {
  std::optional<psf_fit::FittedBeat> psf_corrected;
  std::optional<psf_fit::GaussianProfile> gaussian_profile;
  Notes notes;
};

/// The other readings of surfaces that were measured, `psf_corrected` where `options` ask for it. Both need both
/// surfaces in all gates; implausible ones are left out, with a note. `original`: the study as stored, but for what a
/// person excluded; `looked_at`: on its grid, outside it nothing counts; absent: all of it does.
OtherReadings read_otherwise(const Study& original, const std::optional<Mask>& looked_at, const Options& options,
                             const Progress& progress, StageClock& clock, const Result& result);

/// Sets the reading that leads, its surfaces and its phases.
void choose_leading(Result& result);

/// What is measured on the leading surfaces: along the heart's axis where it was found, else along the
/// stack. Absent without any surface.
std::optional<Measures> measure_study(const Result& result, const MeasureOptions& options);

}  // namespace dynasurf::ventricle
