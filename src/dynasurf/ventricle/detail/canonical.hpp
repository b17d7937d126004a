#pragma once
#include <span>

#include "dynasurf/core/study.hpp"

namespace dynasurf::ventricle {

/// Throws InputError for a study without gates, fewer than 3 slices, fewer than 8 pixels along a side, a value that is
/// not finite, or gates on different grids.
void require_workable(const Study& study);

/// Largest value of all gates; 0 where all are negative. Needs at least one gate and voxel.
float peak_of(std::span<const Image> gates);

/// The study as the pipeline wants it: a short-axis stack from apex to base, values divided by the largest value of
/// all gates (VOL-NORM over the whole data set, so that gates stay comparable).
/// A stack stored base first is reversed. Where the file does not say which end is the apex, the data are asked
/// (`guess_slice_order`) and a note tells. A study without a positive value stays as it is, with "study.empty".
/// Throws InputError for another view (`orient` makes short-axis stacks of those), and as `require_workable` does.
Study canonical_study(Study study);

/// The same stack with its slices in the opposite order; every voxel keeps its place in the world.
Study reverse_slices(Study study);

/// Which end is the apex, from the data: a slice through the apex is bright in its middle, a slice near the base is
/// dark inside a bright ring. `unknown` when the two ends look alike.
SliceOrder guess_slice_order(std::span<const Image> gates);

}  // namespace dynasurf::ventricle
