#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::cloud {

// sRGB (IEC 61966-2-1) and the light it stands for, 0 to 1. Means of colours are means of light.

/// The light of each byte.
inline std::array<double, 256> linear_light() {
  std::array<double, 256> light{};
  for (std::size_t byte = 0; byte < 256; ++byte) {
    const double c = byte / 255.0;
    light[byte] = c <= 0.04045 ? c / 12.92 : own::pow((c + 0.055) / 1.055, 2.4);
  }
  return light;
}

inline std::uint8_t srgb_byte(double light) {
  const double c = light <= 0.0031308 ? 12.92 * light : 1.055 * own::pow(light, 1 / 2.4) - 0.055;
  return std::lround(std::clamp(c, 0.0, 1.0) * 255);
}

}  // namespace dynasurf::cloud
