#pragma once
#include <array>
#include <cstdint>
#include <cstring>
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

  /// Bit by bit: what is not known is like itself.
  bool operator==(const PointCloud& o) const {
    const auto is_same = [](const auto& a, const auto& b) {
      return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0);
    };
    return is_same(points, o.points) && is_same(normals, o.normals) && is_same(colours, o.colours) &&
           is_same(scans, o.scans) && is_same(scanners, o.scanners);
  }
};

/// Points of the heart's muscle that were followed over the beat, as tags or markers show them (FUT-TAGGED). World
/// frame (LPS), mm. Every point is known in every gate.
struct TrackedPoints {
  std::vector<std::string> name;         // per point
  std::vector<std::vector<Vec3>> gates;  // [gate][point]
};

}  // namespace dynasurf
