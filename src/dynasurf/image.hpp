#pragma once
// Intensities, edge detectors, resampling: all public headers of this module.

#include "dynasurf/image/components.hpp"
#include "dynasurf/image/edges.hpp"
#include "dynasurf/image/intensity.hpp"
#include "dynasurf/image/resample.hpp"
