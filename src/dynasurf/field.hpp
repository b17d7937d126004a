#pragma once
// Gradient vector flow: explicit, at rest, near borders alone: all public headers of this module.

#include "dynasurf/field/band.hpp"
#include "dynasurf/field/edge_map.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/field/steady.hpp"
#include "dynasurf/field/vector_field.hpp"
