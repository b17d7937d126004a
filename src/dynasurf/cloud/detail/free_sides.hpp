#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "dynasurf/cloud/detail/orient.hpp"

namespace dynasurf::cloud {

/// Which side of the surface is free at each point: 1 where a ray along its normal meets no other points and one
/// against it does, -1 the other way round, 0 where both do or neither does. Points within four cells are not met.
std::vector<std::int8_t> free_sides(const OrientedPoints& points, double cell);

/// The points with every normal that a free side contradicts turned, and the others after them: sharp edges, where both
/// sides of a body look like one sheet, mislead neighbours, but not rays. Nothing unless most points have one free side
/// and many of their normals lead to the other.
std::optional<OrientedPoints> turned_to_free_sides(const OrientedPoints& points, double cell);

}  // namespace dynasurf::cloud
