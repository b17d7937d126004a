#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dynasurf {

/// The whole number at or below, at or above, and nearest to a value (halves away from zero). The value must lie within
/// the range of int.
inline int floor_int(double x) { return static_cast<int>(std::floor(x)); }
inline int ceil_int(double x) { return static_cast<int>(std::ceil(x)); }
inline int round_int(double x) { return std::lround(x); }

/// Rounded, and kept within what a byte holds.
inline std::uint8_t byte_of(double x) { return std::clamp(std::round(x), 0.0, 255.0); }

/// The whole part of a position, kept within 0 to count - 1; also of far positions, and 0 of NaN.
inline int whole_within(double position, int count) {
  if (!(position > 0)) return 0;  // compared before the conversion: an int must hold it
  return position < count ? static_cast<int>(position) : count - 1;
}

}  // namespace dynasurf
