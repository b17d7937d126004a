#include "dynasurf/dynamics/detail/distance_history.hpp"

namespace dynasurf::dynamics {

void DistanceHistory::look_at(std::span<const std::uint32_t> which, std::span<const Vec3> vertices) {
  for (const std::uint32_t v : which) {
    const double d = border_.voxels(vertices[v], 3);
    bucket_[v] = static_cast<std::uint8_t>(d < 3 ? static_cast<int>(d) : 3);
  }
}

std::array<int, 4> DistanceHistory::count(std::span<const Vec3> vertices, std::span<const std::uint32_t> moving,
                                          std::span<const std::uint32_t> newly_stopped) {
  look_at(newly_stopped, vertices);
  look_at(moving, vertices);
  std::array<int, 4> count{};
  for (const std::uint8_t b : bucket_) ++count[b];
  // "Nearer than 2" includes those nearer than 1.
  return {count[0], count[0] + count[1], count[0] + count[1] + count[2], count[3]};
}

}  // namespace dynasurf::dynamics
