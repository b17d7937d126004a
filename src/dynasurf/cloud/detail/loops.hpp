#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::cloud {

/// The vertices around a hole of an open surface, in the direction of the surface's own triangles.
using Loop = std::vector<std::uint32_t>;

/// All loops of an open surface, those that start at the lowest vertex first. Needs a manifold, oriented surface that
/// touches itself in no single vertex.
std::vector<Loop> loops_of(const TriMesh& open);

/// Where a loop is, and where the surface runs to over it: `aim` is the mean of the directions in which it leaves, near
/// 1 long at the end of a tube and near 0 around a hole in a wall.
struct Rim {
  Vec3 middle = Vec3::Zero(), aim = Vec3::Zero();
  double length = 0;
};

/// The rim of each loop of an open surface, in their order.
std::vector<Rim> rims_of(const TriMesh& open, std::span<const Loop> loops);

}  // namespace dynasurf::cloud
