#pragma once
#include <filesystem>
#include <span>
#include <string_view>

#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/mesh/tetrahedra.hpp"

namespace dynasurf::io {

/// The formats of solids: VTK XML, Gmsh 4.1, Abaqus.
enum class SolidFormat { vtu, msh, inp };
std::span<const std::string_view> names_of(SolidFormat);

/// Writes tetrahedra in world coordinates (LPS, mm): VTK's UnstructuredGrid XML, gmsh 2.2 (ASCII), or an Abaqus input
/// file with nodes and C3D4 elements in the set WALL. Named values per vertex stand in the VTK file only.
/// Whole or not at all. Throws InputError for a solid without tetrahedra or with an index out of range, OptionError for
/// values of another length, IoError.
void write_solid(const mesh::TetMesh& solid, const std::filesystem::path& path, SolidFormat format,
                 std::span<const VertexScalar> scalars = {});

}  // namespace dynasurf::io
