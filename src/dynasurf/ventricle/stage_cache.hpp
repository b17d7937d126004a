#pragma once
#include "dynasurf/core/stage_cache.hpp"

namespace dynasurf::ventricle {

/// What is kept, defined where stages are done.
struct KeptStages;

/// What the stages of the last call of `reconstruct` found, kept by the caller for the next one. A stage is done again
/// only where the study, the mask, the start or one of the options that it or a stage before it depends on has changed.
/// The result is the same, byte for byte; stages that were not done take no time in it (`seconds`). Holds a copy of the
/// study and of what was found, some thirty times its size. Of one call at a time.
using StageCache = dynasurf::StageCache<KeptStages>;

}  // namespace dynasurf::ventricle
