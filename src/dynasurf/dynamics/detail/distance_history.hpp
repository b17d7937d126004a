#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/mesh/detail/border_distance.hpp"

namespace dynasurf::dynamics {

/// How many particles are near the border, step after step (MEAS-DIST, thesis figs 4.12, 5.9).
class DistanceHistory {
 public:
  DistanceHistory(const Image& border, std::size_t particles) : border_(border), bucket_(particles, 3) {}

  /// Particles nearer than 1, 2, 3 voxels to the centre of a border voxel (each with the former), and the others.
  /// Looks at those only that moved in the step; the others are where they were.
  std::array<int, 4> count(std::span<const Vec3> vertices, std::span<const std::uint32_t> moving,
                           std::span<const std::uint32_t> newly_stopped);

 private:
  void look_at(std::span<const std::uint32_t> which, std::span<const Vec3> vertices);

  mesh::BorderDistance border_;
  std::vector<std::uint8_t> bucket_;  // whole voxels from the border, at most 3; per vertex
};

}  // namespace dynasurf::dynamics
