#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::mesh {

/// The triangles whose mark is not 0, in their order, as a mesh of their own; its vertices are those in use, numbered
/// as the triangles first name them. Precondition: one mark per triangle.
TriMesh submesh(const TriMesh& mesh, std::span<const std::uint8_t> kept);

/// Which component each triangle belongs to: triangles that share a vertex are of one. They are numbered from 0 as the
/// triangles first name them; `count` becomes their number. Indices must be in range.
std::vector<std::uint32_t> components_of(const TriMesh& mesh, std::uint32_t& count);

}  // namespace dynasurf::mesh
