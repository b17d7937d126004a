#pragma once
// Studies and clouds with known truth: all public headers of this module.

#include "dynasurf/synthetic/camera.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"
#include "dynasurf/synthetic/options.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/synthetic/terrain.hpp"
#include "dynasurf/synthetic/ventricle_shape.hpp"
