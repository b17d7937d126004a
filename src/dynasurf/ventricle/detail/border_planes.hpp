#pragma once
#include "dynasurf/core/volume.hpp"
#include "dynasurf/dynamics/detail/border_planes.hpp"
#include "dynasurf/image/edges.hpp"
#include "dynasurf/ventricle/labels.hpp"

namespace dynasurf::ventricle {

/// Where a closed border runs inside its voxels, for StopPoint::subvoxel.
/// In a voxel of an edge: at the maximum of the edge strength along the ray from the axis of the ventricle, by the
/// parabola through three samples one pixel apart; the plane stands square to that ray. In a voxel of the disc that
/// closes an end: on the outer face of the end's slice, square to the slices.
/// `border` may lie on a larger grid than the labels (see `with_room`); its planes lie on the same.
dynamics::BorderPlanes border_planes(const Image& border, Border wall, const Labels& labels,
                                     const image::EdgeMap& edges, int base_slice);

}  // namespace dynasurf::ventricle
