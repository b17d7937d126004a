#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/core/grid.hpp"

namespace dynasurf::mesh {

/// The neighbours of a vertex in the order of their directions around its normal, clockwise seen from the normal's tip
/// (GEO-EDGEORDER, thesis 5.5.3, eq. 5.1, with the arc tangent of four quadrants): for meshes whose triangles are not
/// at hand. Returns positions in `neighbours`; the first one whose direction leaves the normal comes first. Neighbours
/// in one direction keep their order; those on the normal itself come last. Only the normal's direction counts.
std::vector<std::uint32_t> order_around(const Vec3& vertex, const Vec3& normal, std::span<const Vec3> neighbours);

}  // namespace dynasurf::mesh
