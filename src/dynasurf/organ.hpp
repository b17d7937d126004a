#pragma once
// The closed surface of a body other than a heart: all public headers of this module.

#include "dynasurf/organ/organ.hpp"
