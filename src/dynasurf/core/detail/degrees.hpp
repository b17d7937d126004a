#pragma once
#include <cmath>

namespace dynasurf {

/// One degree in radians: 90 * degrees is a right angle.
constexpr double degrees = M_PI / 180;

}  // namespace dynasurf
