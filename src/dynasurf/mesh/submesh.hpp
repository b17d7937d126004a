#pragma once
#include <cstdint>
#include <span>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf {

/// The triangles whose mark is not 0, in their order, as a mesh of their own; its vertices are those in use, numbered
/// as the triangles first name them. Precondition: one mark per triangle.
TriMesh submesh(const TriMesh& mesh, std::span<const std::uint8_t> kept);

}  // namespace dynasurf
