#pragma once
#include "dynasurf/core/stage_clock.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf {

/// Volumes, ejection fraction and phases of the edge surfaces, where all gates have them.
void measure_cycle(VentricleResult& result);

/// Readings beside the edges' own, `qgs_like` and, where `options` ask for it, `fit`, with their notes. Both need both
/// surfaces in all gates; what cannot be believed is left out, with a note. `original`: the study as it was stored.
void read_otherwise(const Study& original, const BlurFit& options, const Progress& progress, StageClock& clock,
                    VentricleResult& result);

/// What is measured on the fitted walls, else on the edges: along the heart's axis where it was found, else along the
/// stack. Absent without any surface.
std::optional<Measures> measure_study(const VentricleResult& result, const MeasureOptions& options);

}  // namespace dynasurf
