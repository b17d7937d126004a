#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/io/detail/mesh_parts.hpp"
#include "dynasurf/mesh/tetrahedra.hpp"

namespace dynasurf::io {

/// Writes a mesh with the coordinates it has: binary little-endian PLY with normals, binary STL, OBJ, OFF, VTK PolyData
/// XML, binary glTF, or 3MF for printers. Coordinates are kept exactly, but for STL and GLB, which hold single
/// precision, GLB around the middle of the mesh. Whole or not at all. Colours are written where the format can hold
/// them (ply, obj, off, glb). Throws InputError for a mesh without triangles, with an index out of range or a vertex
/// that is not finite, OptionError for scalars or colours of another length or a name that is no plain word, IoError.
void write_mesh(const TriMesh& mesh, const std::filesystem::path& path, MeshFormat format,
                std::span<const VertexScalar> scalars = {}, const VertexColours& colours = {});

/// Reads PLY (ascii, binary little and big endian), STL (ascii, binary; equal corners welded), OBJ, OFF, told by the
/// name's ending. Faces with more corners are cut into a fan of triangles; normals, colours, textures and other
/// elements are left out. The triangles are those of the file, flat ones too.
/// Strict: cut short, declared longer than it is, an index out of range, a coordinate that is not finite, no triangle,
/// a text without its last line break: all refused, also an OBJ whose first comments tell of more vertices or faces.
/// Only an OBJ without such comments cannot be told from a whole one when it is cut at the end of a line, and an ascii
/// STL of several solids when it is cut between two.
/// Time is linear in the file. At most 2 GiB, 1 MiB a line, 1024 properties and 256 elements of a PLY; the mesh must
/// fit the limit of memory. Throws InputError naming the file and the line or byte, IoError when it cannot be read.
TriMesh read_mesh(const std::filesystem::path& path);

/// A surface that moves through the gates of a beat.
struct AnimatedSurface {
  std::string name;
  std::array<float, 4> colour{1, 1, 1, 1};  // RGBA, linear, 0 to 1; alpha below 1: translucent, seen from both sides
  std::vector<TriMesh> cycle;               // one mesh per gate, same triangles
};
/// The beating heart as one binary glTF: a node per surface, the first gate as base mesh and one morph target (position
/// and normal) per further gate, an animation over `cycle_s` seconds that visits the gates at equal steps and returns
/// to the first. A surface of one gate stands still.
/// glTF has metres, Y up, Z towards the viewer: (x, y, z) of LPS mm becomes (x, z, -y) / 1000, so the patient stands
/// upright and faces the viewer, and nothing is mirrored. The same input gives the same bytes.
/// Throws InputError for a surface without mesh or triangle or with meshes that differ in their triangles, OptionError
/// for a cycle that is not positive or a colour out of range, IoError.
void write_glb(std::span<const AnimatedSurface> surfaces, double cycle_s, const std::filesystem::path& path);

/// Levels of detail, finest first, as one binary glTF: a node and mesh per level. The scene shows the finest; its node
/// names the others by the extension MSFT_lod with their screen coverage, which viewers that do not know it leave
/// alone. Coordinates and unit are those of the meshes, seen from the middle of the box around the finest, which the
/// nodes' translation holds: positions far from the origin keep their precision.
/// Throws InputError for no level, a mesh that cannot be written or textures that do not fit their corners, OptionError
/// for colours of another length, IoError.
void write_lod_glb(std::span<const LodSurface> levels, const std::filesystem::path& path);

/// The same levels in a quarter of the bytes or less, for viewers: places of 16 bits (KHR_mesh_quantization; a step is
/// 1/65535 of the longest side of the box around all levels), normals of 8, packed by meshoptimizer
/// (EXT_meshopt_compression). Vertices and triangles stand in another order, vertices without a triangle are left out,
/// and textures too. Certificates do not hold for the rounded places. Throws as `write_lod_glb`.
void write_packed_lod_glb(std::span<const LodSurface> levels, const std::filesystem::path& path);

/// The names and meshes of a file of `write_lod_glb`, in the file's order, without colours and textures; places as
/// exact as its numbers of 32 bits. The file may come from anybody: nothing outside it is opened, and what does not lie
/// within it is refused. Throws InputError naming the file and the place for a file that is none, for textured levels,
/// whose triangles share no vertices, for vertices that are not finite and triangles of vertices that are not there;
/// IoError when it cannot be read.
std::vector<LodSurface> read_lod_glb(const std::filesystem::path& path);

/// ParaView time series: entries of (time, file relative to the .pvd, part number).
struct PvdEntry {
  double time = 0;
  std::string file;
  int part = 0;
};
/// Writes the series; the file appears whole or not at all. Throws IoError.
void write_pvd(std::span<const PvdEntry> entries, const std::filesystem::path& path);

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
