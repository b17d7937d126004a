#pragma once
#include <limits>
#include <vector>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::mesh {

/// Answers how far a point is from the nearest centre of a non-zero voxel: exact, for any point inside or outside the
/// grid. Building it is one pass over the volume; a question costs the rows of voxels nearer than the answer.
class BorderDistance {
 public:
  explicit BorderDistance(const Image& border);

  /// Euclidean distance of a point of the grid frame in voxels (differences divided by the spacing). Infinity when
  /// there is no border voxel; answers above `limit` may come back as infinity, sooner.
  double voxels(const Vec3& grid_mm, double limit = std::numeric_limits<double>::infinity()) const {
    return distance(grid_mm.cwiseQuotient(grid_.spacing), Vec3::Ones(), limit);
  }
  /// The same in mm.
  double mm(const Vec3& grid_mm, double limit_mm = std::numeric_limits<double>::infinity()) const {
    return distance(grid_mm.cwiseQuotient(grid_.spacing), grid_.spacing, limit_mm);
  }

 private:
  std::size_t row_of(int j, int k) const { return static_cast<std::size_t>(k) * grid_.dims[1] + j; }
  double distance(const Vec3& index, const Vec3& scale, double limit) const;

  Grid grid_;
  // The columns of the border voxels, row after row along i, and where each row begins among them; one past the last.
  std::vector<std::int32_t> columns_;
  std::vector<std::size_t> row_begin_;
};

}  // namespace dynasurf::mesh
