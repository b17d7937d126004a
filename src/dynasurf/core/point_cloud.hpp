#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "dynasurf/core/grid.hpp"

namespace dynasurf {

/// Points of a scanned surface, in any unit of length and any order. Each of the other arrays, but for the last, is
/// empty or has one entry per point.
struct PointCloud {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;                         // any length but 0, outwards
  std::vector<std::array<std::uint8_t, 3>> colours;  // sRGB
  std::vector<std::uint32_t> scans;                  // which scan a point comes from; none: all from scan 0
  std::vector<Vec3> scanners = {};                   // per scan, where it was taken from; not finite: not known
  bool operator==(const PointCloud&) const = default;
};

/// Points of the heart's muscle that were followed over the beat, as tags or markers show them (FUT-TAGGED). World
/// frame (LPS), mm. Every point is known in every gate.
struct TrackedPoints {
  std::vector<std::string> name;         // per point
  std::vector<std::vector<Vec3>> gates;  // [gate][point]
};

}  // namespace dynasurf
