#pragma once
#include <cmath>

namespace dynasurf {

/// The whole number at or below, at or above, and nearest to a value (halves away from zero). The value must lie within
/// the range of int.
inline int floor_int(double x) { return static_cast<int>(std::floor(x)); }
inline int ceil_int(double x) { return static_cast<int>(std::ceil(x)); }
inline int round_int(double x) { return static_cast<int>(std::lround(x)); }

}  // namespace dynasurf
