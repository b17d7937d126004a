#pragma once
#include "dynasurf/report/detail/page_parts.hpp"
#include "dynasurf/ventricle/result.hpp"

// How the surfaces of end diastole (the first gate, where it is not known) were found, for the page of a result.
namespace dynasurf::report::detail {

/// Of the voxels around a border: which are of it, the field, and the drag where it differs from place to place (else
/// null). They count from the first voxel of the study. Null where there are none or too many for a page.
Json surroundings_json(const Image& border_volume, const field::VectorField& field, const Image* drag_map,
                       const Grid& study);

/// The way of each surface to its border, the border, and the field around it; null where no step was kept.
Json evolution_json(const ventricle::Result& result);

/// The contours of each wall, slice by slice, with the forces on their points; null for other pipelines.
Json contours_json(const ventricle::Result& result);

}  // namespace dynasurf::report::detail
