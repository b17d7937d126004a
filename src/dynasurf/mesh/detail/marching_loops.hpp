#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

// What discretised marching cubes does with the loops of a cell and with the facets they give.
namespace dynasurf::mesh {

/// Triangles that fill a loop of edges of a cell, as places in the loop.
struct FlatFilling {
  std::vector<std::array<std::size_t, 3>> triangles;
  bool fan_from_middle = false;  // instead: one triangle for each side of the loop, from the middle of the cell
};

/// The filling whose triangles lie in planes with normals of -1, 0 and 1 where there is one, else with the fewest that
/// do not. No triangle has a side within a face of the cell beside the loop's own. Edges are numbered as in
/// marching_cubes.cpp: 4 axis + the other two bits of the low corner.
FlatFilling flat_filling(std::span<const int> loop, bool may_use_middle);

/// The closed surface whose vertices lie on a lattice of half voxels, with fewer triangles in the same place: vertices
/// in the middle of a plane or of a straight ridge are merged into a neighbour while that moves nothing. Exact.
TriMesh merged_facets(TriMesh mesh, const Vec3& spacing);

}  // namespace dynasurf::mesh
