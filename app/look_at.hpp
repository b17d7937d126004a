#pragma once
#include <string>

#include "dynasurf/ventricle/result.hpp"

namespace dynasurf::app {

/// One line: what a person should look at first in a result that is not "ok", and what helps. Empty for "ok".
std::string look_at(const ventricle::Result& result);

}  // namespace dynasurf::app
