#pragma once
#include <optional>
#include <vector>

#include "dynasurf/ventricle/labels/detail/circle.hpp"
#include "dynasurf/ventricle/labels/detail/mlc.hpp"

namespace dynasurf::ventricle {

/// How full the ventricle looks: in each slice with a circular edge, brightness of its middle over that of the
/// brightest ring inside, and of these the median. A wall around a dark cavity has 0.1 to 0.9, a cavity that is bright
/// itself about 1. 0 when fewer than 5 slices have a circular edge: a few may be gut, or the solid apex of a wall.
double filling(const Image& image, const std::vector<std::optional<Circle>>& local);

/// Share of the edges across which the image brightens outwards, as it does across the inner border of a wall. A blood
/// pool has hardly any. 0 without edges.
double inner_share(const SidedEdges& edges);

/// Whether a full ventricle with hardly an inner border is one of the blood pool.
bool is_blood_pool(double filling, double inner_share);

/// The borders of a blood pool. It has one, the inner border of the wall, across which the image darkens outwards as
/// across the outer border of a perfused wall: what the methods call outer is inner here, and there is no other.
Mask borders_of_pool(Mask borders);

/// The highest slice under the end of a bright cavity: below its middle the first one that is less than half as bright
/// on the axis. -1 when the cavity reaches the lowest slice, or there is none.
int division_slice_of_pool(const std::vector<double>& centre_profile);

}  // namespace dynasurf::ventricle
