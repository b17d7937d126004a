#pragma once
#include <string>

#include "dynasurf/ventricle/result.hpp"

namespace dynasurf::app {

/// The short table on the terminal: a row per gate, the readings, the verdict with its reasons.
std::string summary_of(const ventricle::Result& result);

}  // namespace dynasurf::app
