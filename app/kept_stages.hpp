#pragma once
#include "dynasurf/cloud/stage_cache.hpp"
#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/core/study.hpp"
#include "dynasurf/ventricle/stage_cache.hpp"

namespace dynasurf::app {

/// What the run before this one found in the same process; null where every run has a process of its own, and for
/// inputs that would take too much memory.
ventricle::StageCache* kept_stages(const Study& study);
cloud::StageCache* kept_stages(const PointCloud& cloud);

}  // namespace dynasurf::app
