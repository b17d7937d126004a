#pragma once
// Intensities, edge detectors, resampling: all public headers of this module.

#include "dynasurf/image/edges.hpp"
#include "dynasurf/image/intensity.hpp"
