#pragma once
#include "dynasurf/core/detail/stage_clock.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/result.hpp"

namespace dynasurf::ventricle {

/// Volumes and ejection fraction of the edge surfaces, where all gates have them: `readings.edge`.
void measure_cycle(Result& result);

/// Readings beside the edge's, `gaussian_profile` and, where `options` ask for it, `psf_corrected`, with their notes.
/// Both need both surfaces in all gates; implausible ones are left out, with a note. `original`: the study as stored,
/// but for what a person excluded; `looked_at`: on its grid, outside it nothing counts; absent: all of it does.
void read_otherwise(const Study& original, const std::optional<Mask>& looked_at, const Options& options,
                    const Progress& progress, StageClock& clock, Result& result);

/// Sets the reading that leads, its surfaces and its phases.
void choose_leading(Result& result);

/// What is measured on the leading surfaces: along the heart's axis where it was found, else along the
/// stack. Absent without any surface.
std::optional<Measures> measure_study(const Result& result, const MeasureOptions& options);

}  // namespace dynasurf::ventricle
