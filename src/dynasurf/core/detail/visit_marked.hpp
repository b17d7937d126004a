#pragma once
#include "dynasurf/core/volume.hpp"

namespace dynasurf {

/// Calls `visit(i, j)` for the voxels of slice `k` whose value `is_marked`, row by row, each row from the left. Nearly
/// all rows of a border have none: they are looked at whole, by vectors, and passed.
template <class Voxel, class IsMarked, class Visit>
void visit_marked(const Volume<Voxel>& volume, int k, const IsMarked& is_marked, const Visit& visit) {
  const int width = volume.grid.dims[0];
  for (int j = 0; j < volume.grid.dims[1]; ++j) {
    const Voxel* row = volume.values.data() + volume.grid.index(0, j, k);
    unsigned char some = 0;
    for (int i = 0; i < width; ++i) some |= is_marked(row[i]);
    if (some == 0) continue;
    for (int i = 0; i < width; ++i)
      if (is_marked(row[i])) visit(i, j);
  }
}

/// The same for the voxels that are not 0.
template <class Voxel, class Visit>
void visit_marked(const Volume<Voxel>& volume, int k, const Visit& visit) {
  visit_marked(
      volume, k, [](Voxel voxel) { return voxel != 0; }, visit);
}

}  // namespace dynasurf
