#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "dynasurf/core/grid.hpp"

namespace dynasurf {

/// One value per voxel, i fastest, then j, then k. `values.size() == grid.size()` always holds.
template <class T>
struct Volume {
  Grid grid;
  std::vector<T> values;

  Volume() = default;
  explicit Volume(const Grid& g, T fill = T{}) : grid(g), values(g.size(), fill) {}

  T& operator()(int i, int j, int k) { return values[grid.index(i, j, k)]; }
  const T& operator()(int i, int j, int k) const { return values[grid.index(i, j, k)]; }

  /// Value at the nearest voxel inside the grid: the replicated border of every stencil.
  const T& clamped(int i, int j, int k) const {
    return (*this)(std::clamp(i, 0, grid.dims[0] - 1), std::clamp(j, 0, grid.dims[1] - 1),
                   std::clamp(k, 0, grid.dims[2] - 1));
  }
  bool operator==(const Volume&) const = default;
};

/// Voxels with values; and voxels that are in (1) or out (0).
using Image = Volume<float>;
using Mask = Volume<std::uint8_t>;

}  // namespace dynasurf
