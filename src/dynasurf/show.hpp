#pragma once
// Pictures of what a run passed through: all public headers of this module.

#include "dynasurf/show/show.hpp"
