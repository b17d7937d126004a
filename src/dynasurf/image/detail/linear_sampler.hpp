#pragma once
#include <algorithm>
#include <cstddef>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::image {

/// Voxels along one axis of a grid.
struct SampledAxis {
  double spacing, last;  // `last`: the last voxel
  int last_low;          // the last voxel that has a next one
};
inline SampledAxis sampled_axis(const Grid& grid, int axis) {
  const int count = grid.dims[axis];
  return {grid.spacing[axis], count - 1.0, std::max(0, count - 2)};
}

/// A point's place between voxels along one axis.
struct PlaceOnAxis {
  int low;
  double share;  // 0 at `low`, 1 at the next voxel
};
inline PlaceOnAxis place_on(const SampledAxis& axis, double mm) {
  const double at = std::clamp(mm / axis.spacing, 0.0, axis.last);
  const int low = std::min<int>(at, axis.last_low);
  return {low, at - low};
}

/// `sample_linear` of one image at many places: what is the same for all of them is worked out once. Refers to the
/// image, which must outlive it.
class LinearSampler {
 public:
  explicit LinearSampler(const Image& image)
      : values_(image.values.data()),
        x_(sampled_axis(image.grid, 0)),
        y_(sampled_axis(image.grid, 1)),
        z_(sampled_axis(image.grid, 2)),
        row_(image.grid.dims[0]),
        slice_(row_ * image.grid.dims[1]),
        next_x_(image.grid.dims[0] > 1 ? 1 : 0),
        next_y_(image.grid.dims[1] > 1 ? row_ : 0),
        next_z_(image.grid.dims[2] > 1 ? slice_ : 0) {}

  double operator()(const Vec3& mm) const {
    const PlaceOnAxis x = place_on(x_, mm[0]), y = place_on(y_, mm[1]), z = place_on(z_, mm[2]);
    const float* const v = values_ + x.low + y.low * row_ + z.low * slice_;
    const auto along_x = [&](Index at) { return v[at] + x.share * (v[at + next_x_] - v[at]); };
    const auto along_y = [&](Index at) {
      const double low = along_x(at), high = along_x(at + next_y_);
      return low + y.share * (high - low);
    };
    const double low = along_y(0), high = along_y(next_z_);
    return low + z.share * (high - low);
  }

 private:
  const float* values_;
  SampledAxis x_, y_, z_;
  Index row_, slice_;               // from a voxel to that of the next row, of the next slice
  Index next_x_, next_y_, next_z_;  // 0 where there is one voxel
};

}  // namespace dynasurf::image
