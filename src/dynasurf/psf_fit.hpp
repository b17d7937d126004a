#pragma once
// Surfaces of all gates fitted through the point spread: all public headers of this module.

#include "dynasurf/psf_fit/blur_fit.hpp"
#include "dynasurf/psf_fit/gaussian_profile.hpp"
