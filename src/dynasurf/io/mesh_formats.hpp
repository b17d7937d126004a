#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/io/mesh_io.hpp"

// The doors between mesh_io.cpp and the mesh formats, one source each. A format turns a mesh into bytes and bytes into
// a mesh; files, names and the checks that all formats share stay in mesh_io.cpp.
namespace dynasurf::io_detail {

/// The whole content of a file and the name to blame.
struct MeshFile {
  std::string name;
  std::string_view bytes;
};

/// Throws InputError "NAME: line 12: REASON", or byte 12, or without a place when `unit` is empty.
[[noreturn]] void refuse(const MeshFile& file, std::string_view unit, std::size_t place, const std::string& reason);

/// A word of a file as it may stand in a message: 'word', at most 40 characters, unprintable ones as ?.
std::string quoted(std::string_view word);

// Encoders. Precondition: the mesh has passed `check_writable`.
std::string encode_ply(const TriMesh& mesh, std::span<const VertexScalar> scalars);
std::string encode_vtp(const TriMesh& mesh, std::span<const VertexScalar> scalars);
std::string encode_stl(const TriMesh& mesh);
std::string encode_obj(const TriMesh& mesh);
std::string encode_off(const TriMesh& mesh);

// Decoders. They throw InputError; indices of the mesh they return are in range and coordinates finite.
TriMesh decode_ply(const MeshFile& file);
TriMesh decode_stl(const MeshFile& file);
TriMesh decode_obj(const MeshFile& file);
TriMesh decode_off(const MeshFile& file);

/// Throws InputError unless the mesh has triangles, indices in range and finite vertices, or OptionError when a scalar
/// does not fit the mesh or its name is not a plain word. `what` names the output.
void check_writable(const TriMesh& mesh, std::span<const VertexScalar> scalars, const std::string& what);

/// Unit normals of the vertices, pointing outwards: the area-weighted mean of the triangles around each. Where there is
/// none (no triangle, or all flat) +z stands in, because glTF allows no normal of another length than 1.
std::vector<Eigen::Vector3f> vertex_normals(const TriMesh& mesh);

/// Cuts a face of three or more corners into a fan of triangles around its first corner.
void add_fan(TriMesh& mesh, std::span<const std::uint32_t> corners);

}  // namespace dynasurf::io_detail
