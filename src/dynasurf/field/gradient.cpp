#include "dynasurf/field/detail/gradient.hpp"

#include <cmath>
#include <limits>
#include <string>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::field::detail {

double largest_gradient_squared(const Image& f) {
  const Index3& n = f.grid.dims;
  return parallel_max(n[2], 4, [&](std::size_t begin, std::size_t end) {
    double largest = 0;
    for (std::size_t k = begin; k < end; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) largest = std::max(largest, gradient_at(f, i, j, k).squaredNorm());
    return largest;
  });
}

void check_grid(const Image& f) {
  if (f.grid.size() == 0 || f.values.size() != f.grid.size())
    throw InputError("edge map: the grid has " + std::to_string(f.grid.size()) + " voxels and there are " +
                     std::to_string(f.values.size()) + " values; expected one value for each of at least one voxel");
  if (!(f.grid.spacing.minCoeff() > 0) || !f.grid.spacing.allFinite())
    throw InputError("edge map: the spacing must be positive along every axis");
}

void check_edge_map(const Image& f) {
  check_grid(f);
  for (std::size_t v = 0; v < f.values.size(); ++v)
    if (!std::isfinite(f.values[v]))
      throw InputError("edge map: voxel number " + std::to_string(v) + " is not a finite number");
  if (largest_gradient_squared(f) > std::numeric_limits<float>::max())
    throw InputError("edge map: its gradient is too steep for single precision; scale the map to a maximum of 1");
}

}  // namespace dynasurf::field::detail
