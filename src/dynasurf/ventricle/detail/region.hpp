#pragma once
#include "dynasurf/core/study.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::ventricle {

/// Which voxels of `grid` a mask covers: those whose nearest voxel of `mask`, in the world, is above 0. A voxel outside
/// the mask's grid is not covered.
Mask region_on(const Image& mask, const Grid& grid);

/// The study as if it ended at the rim of a region (its own grid): outside, values go on from the rim and change only
/// smoothly, as they do beyond the border of a grid. So nothing hot out there sets a threshold, and the rim itself is
/// no edge. Adds the note "region.used". Throws InputError when the region covers no voxel.
Study confine(Study study, const Mask& region);

/// A label map as a mask: 1 where a voxel has the value, else 0. Throws InputError where no voxel of the study has it.
Study only_label(Study study, int label);

/// Edges outside the region are no border of the ventricle.
void clear_outside(Mask& edges, const Mask& region);

}  // namespace dynasurf::ventricle
