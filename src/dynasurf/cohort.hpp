#pragma once
// Many studies at once, and what they say together: all public headers of this module.

#include "dynasurf/cohort/collect.hpp"
#include "dynasurf/cohort/status.hpp"
#include "dynasurf/cohort/study_list.hpp"
