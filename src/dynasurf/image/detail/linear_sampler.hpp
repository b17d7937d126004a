#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

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
  // Not by `std::clamp`: its references keep compilers from making vectors.
  const double at = std::min(std::max(mm / axis.spacing, 0.0), axis.last);
  const int low = std::min<int>(at, axis.last_low);
  return {low, at - low};
}

/// Points to look at together, `most` at most; mm of the grid frame.
template <std::size_t most>
struct SampledPoints {
  std::array<double, most> x, y, z;
  std::size_t count = 0;

  void put(std::size_t at, const Vec3& mm) { x[at] = mm[0], y[at] = mm[1], z[at] = mm[2]; }
  void add(const Vec3& mm) { put(count++, mm); }
};

/// `sample_linear` of one image at many places: what is the same for all of them is worked out once. Refers to the
/// image, which must outlive it.
class LinearSampler {
 public:
  explicit LinearSampler(const Image& image)
      : values_(image.values.data()),
        size_(image.values.size()),
        x_(sampled_axis(image.grid, 0)),
        y_(sampled_axis(image.grid, 1)),
        z_(sampled_axis(image.grid, 2)),
        row_(image.grid.dims[0]),
        slice_(row_ * image.grid.dims[1]),
        next_x_(image.grid.dims[0] > 1 ? 1 : 0),
        next_y_(image.grid.dims[1] > 1 ? row_ : 0),
        next_z_(image.grid.dims[2] > 1 ? slice_ : 0) {}

  double operator()(const Vec3& mm) const { return at<Index>(mm[0], mm[1], mm[2]); }

  /// The values at many points, one after another in `to`, for any instruction set.
  template <std::size_t most>
  void operator()(const SampledPoints<most>& points, double* to) const {
    at_all(points.x.data(), points.y.data(), points.z.data(), points.count, to);
  }

 private:
  void at_all(const double* x, const double* y, const double* z, std::size_t count, double* to) const;

  /// `Offset` holds the number of voxels: with a short one, loops over points become vectors.
  template <class Offset>
  double at(double x_mm, double y_mm, double z_mm) const {
    const PlaceOnAxis x = place_on(x_, x_mm), y = place_on(y_, y_mm), z = place_on(z_, z_mm);
    const Offset row = row_, slice = slice_, next_x = next_x_, next_y = next_y_, next_z = next_z_;
    const auto along_x = [&](Offset at) { return values_[at] + x.share * (values_[at + next_x] - values_[at]); };
    const auto along_y = [&](Offset at) {
      const double low = along_x(at), high = along_x(at + next_y);
      return low + y.share * (high - low);
    };
    const Offset first = x.low + y.low * row + z.low * slice;
    const double low = along_y(first), high = along_y(first + next_z);
    return low + z.share * (high - low);
  }

  const float* values_;
  std::size_t size_;
  SampledAxis x_, y_, z_;
  Index row_, slice_;               // from a voxel to that of the next row, of the next slice
  Index next_x_, next_y_, next_z_;  // 0 where there is one voxel
};

}  // namespace dynasurf::image
