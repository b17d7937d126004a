#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/core/grid.hpp"

namespace dynasurf::cloud {

/// A point's number, and the cubic cell that holds it.
struct InCell {
  std::uint64_t cell;
  std::uint32_t index;
};

/// Points sorted by the cells of a lattice that hold them, those of one cell by their numbers. `origin` is below all
/// points, which span fewer than 2^21 cells along every axis.
std::vector<InCell> by_cell(std::span<const Vec3> points, const Vec3& origin, double side);

}  // namespace dynasurf::cloud
