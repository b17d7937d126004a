#pragma once
#include <mutex>

#include "dynasurf/cloud/stage_cache.hpp"
#include "dynasurf/ventricle/stage_cache.hpp"

namespace dynasurf::python {

/// What the last run found, for the next one. Threads of Python use it in turn.
struct StageCache {
  ventricle::StageCache ventricle;
  cloud::StageCache cloud;
  std::mutex in_use;
};

}  // namespace dynasurf::python
