#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::dynamics {

/// Where a straight path first meets a border voxel.
struct BorderHit {
  Index3 voxel;
  Vec3 entry;  // grid frame, mm; the start of the path when it starts inside
};

/// The non-zero voxels of a border, asked along paths.
class BorderPath {
 public:
  explicit BorderPath(const Image& border);

  /// Walks all voxels of the path from one point of the grid frame to another, by faces (3D-DDA of Amanatides and Woo),
  /// so no border without gaps can be jumped, however long the path. Voxels outside the grid are no border.
  /// Precondition: finite points within 2^30 voxels of the origin.
  std::optional<BorderHit> first_hit(const Vec3& from_mm, const Vec3& to_mm) const;

 private:
  bool is_border(const Index3& v) const {
    return grid_.contains(v[0], v[1], v[2]) && is_border_[grid_.index(v[0], v[1], v[2])] != 0;
  }

  Grid grid_;
  Vec3 per_mm_;  // voxels per mm
  std::vector<std::uint8_t> is_border_;
};

}  // namespace dynasurf::dynamics
