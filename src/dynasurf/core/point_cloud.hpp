#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "dynasurf/core/geometry.hpp"

namespace dynasurf {

/// Points of a scanned surface, in any unit of length and any order. Each of the other arrays is empty or has one entry
/// per point.
struct PointCloud {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;                         // any length but 0, outwards
  std::vector<std::array<std::uint8_t, 3>> colours;  // sRGB
  std::vector<std::uint32_t> scans;                  // which scan a point comes from
};

}  // namespace dynasurf
