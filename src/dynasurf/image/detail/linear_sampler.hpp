#pragma once
#include <algorithm>
#include <array>
#include <cstddef>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::image {

/// `sample_linear` of one image at many places: what is the same for all of them is worked out once. Refers to the
/// image, which must outlive it.
class LinearSampler {
 public:
  explicit LinearSampler(const Image& image)
      : values_(image.values.data()),
        x_(axis_of(image.grid, 0, 1)),
        y_(axis_of(image.grid, 1, image.grid.dims[0])),
        z_(axis_of(image.grid, 2, image.grid.index(0, 0, 1))) {}

  double operator()(const Vec3& mm) const {
    const Place x = place(x_, mm[0]), y = place(y_, mm[1]), z = place(z_, mm[2]);
    const float* const v = values_ + x.offset + y.offset + z.offset;
    const auto along_x = [&](std::ptrdiff_t at) { return v[at] + x.share * (v[at + x_.next] - v[at]); };
    const auto along_y = [&](std::ptrdiff_t at) {
      const double low = along_x(at), high = along_x(at + y_.next);
      return low + y.share * (high - low);
    };
    const double low = along_y(0), high = along_y(z_.next);
    return low + z.share * (high - low);
  }

 private:
  struct Axis {
    double spacing, most;  // `most`: the last voxel
    int last_low;          // the last voxel that has a next one
    std::ptrdiff_t stride, next;
  };
  /// A point's place between voxels along one axis.
  struct Place {
    std::ptrdiff_t offset;
    double share;  // 0 at `offset`, 1 at the next voxel
  };

  static Axis axis_of(const Grid& grid, std::size_t axis, std::size_t stride) {
    const int count = grid.dims[axis];
    const auto step = static_cast<std::ptrdiff_t>(stride);
    return {grid.spacing[static_cast<Eigen::Index>(axis)], count - 1.0, std::max(0, count - 2), step,
            count > 1 ? step : 0};
  }

  static Place place(const Axis& axis, double mm) {
    const double at = std::clamp(mm / axis.spacing, 0.0, axis.most);
    const int low = std::min(static_cast<int>(at), axis.last_low);
    return {low * axis.stride, at - low};
  }

  const float* values_;
  Axis x_, y_, z_;
};

}  // namespace dynasurf::image
