#pragma once
#include "dynasurf/cloud/options.hpp"
#include "dynasurf/cloud/result.hpp"
#include "dynasurf/cloud/stage_cache.hpp"
#include "dynasurf/core/progress.hpp"

namespace dynasurf::cloud {

/// Surfaces from points (thesis 6.2; GEN-*), closed, or open where `options.boundary` says so. Every level is fitted to
/// the points themselves. A level that is not sound (see `is_sound`) says so in its certificate, and a note of severity
/// failure stands in the result, as it does
/// ("cloud.no_surface") where the points fill space instead of lying on a surface. The same bytes for any
/// number of threads. Progress stages: "points", "inside", "surface", "levels". Throws OptionError for an option out
/// of range, InputError for fewer than 10 usable points, or points that all lie in one plane.
/// `cache`: what an earlier call found, for stages that need not be done again; null: all are.
Result reconstruct(PointCloud cloud, const Options& options, const Progress& progress = {},
                   StageCache* cache = nullptr);

}  // namespace dynasurf::cloud
