#pragma once
// Pictures of what a run passed through: all public headers of this module.

#include "dynasurf/show/canvas.hpp"
#include "dynasurf/show/pictures.hpp"
#include "dynasurf/show/scene.hpp"
#include "dynasurf/show/show.hpp"
