#pragma once
// Grids, volumes, studies, meshes, options, progress and errors: all public headers of this module.

#include "dynasurf/core/contour.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/grid.hpp"
#include "dynasurf/core/note.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/core/progress.hpp"
#include "dynasurf/core/stage_cache.hpp"
#include "dynasurf/core/study.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"
