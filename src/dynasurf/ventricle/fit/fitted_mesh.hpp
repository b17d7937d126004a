#pragma once
#include "dynasurf/ventricle/fit/blur_fit.hpp"
#include "dynasurf/ventricle/fit/least_squares.hpp"

namespace dynasurf {

/// Turns a solution into surfaces, volumes and their error bars. Internal.
void describe_beat(const BeatProblem& problem, const Solution& solution, const Grid& grid, FittedBeat& beat);

}  // namespace dynasurf
