#pragma once
// Where the left ventricle lies, its valve plane and its volumes over the beat: all public headers of this module.

#include "dynasurf/heart/base_plane.hpp"
#include "dynasurf/heart/locate.hpp"
#include "dynasurf/heart/lv_volumes.hpp"
