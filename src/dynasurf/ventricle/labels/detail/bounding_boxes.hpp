#pragma once
#include "dynasurf/ventricle/labels.hpp"

namespace dynasurf::ventricle {

/// BBOX-FILTER (thesis 2.6): vertical coherence. The slices of a ventricle nest: above the big slice no border may
/// leave the box of the big slice, and going down no slice may leave the boxes of the slices above it. Border voxels
/// outside are removed, each border by itself: both down to the division slice, the outer one to the apex. Boxes are
/// those of already filtered slices, enlarged by `margin_px`, and move along with the axis. A border seen by less than
/// `least_coverage_deg` around the axis in a slice gives no box there; the box of the slice above stays in force.
/// Filtering twice changes nothing more. Without a big slice nothing is removed ("boxes.no_big_slice"); "boxes.removed"
/// counts what was.
Mask filter_by_boxes(Mask borders, int big_slice, int division_slice, const Axis& axis, double margin_px,
                     double least_coverage_deg, Notes& notes);

}  // namespace dynasurf::ventricle
