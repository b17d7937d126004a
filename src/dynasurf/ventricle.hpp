#pragma once
// From a study to the surfaces and numbers of the left ventricle: all public headers of this module.

#include "dynasurf/ventricle/label_borders.hpp"
#include "dynasurf/ventricle/labels.hpp"
#include "dynasurf/ventricle/measures/measures.hpp"
#include "dynasurf/ventricle/measures/normal_limits.hpp"
#include "dynasurf/ventricle/measures/tracked_motion.hpp"
#include "dynasurf/ventricle/measures/wall_solid.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"
#include "dynasurf/ventricle/result.hpp"
#include "dynasurf/ventricle/stage_cache.hpp"
