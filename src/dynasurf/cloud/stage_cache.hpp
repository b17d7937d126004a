#pragma once
#include "dynasurf/core/stage_cache.hpp"

namespace dynasurf::cloud {

/// What is kept, defined where stages are done.
struct KeptStages;

/// What the stages of the last call of `reconstruct` found, kept by the caller for the next one: the points and the
/// body. A stage is done again only where the cloud or one of the options that it or a stage before it depends on has
/// changed. The result is the same, byte for byte. Holds the cloud three times, and the fields of the body. Of one call
/// at a time.
using StageCache = dynasurf::StageCache<KeptStages>;

}  // namespace dynasurf::cloud
