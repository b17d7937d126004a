#pragma once
// Files of studies, meshes, clouds, pictures and options: all public headers of this module.

#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/io/study_io.hpp"
