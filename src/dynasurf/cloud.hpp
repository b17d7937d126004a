#pragma once
// From points to closed meshes at any number of triangles: all public headers of this module.

#include "dynasurf/cloud/lod.hpp"
#include "dynasurf/cloud/options.hpp"
#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/cloud/result.hpp"
#include "dynasurf/cloud/stage_cache.hpp"
