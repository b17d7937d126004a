#pragma once
#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf {

enum class MeshFormat { ply, stl, obj, off, vtp };
std::span<const std::string_view> names_of(MeshFormat);

/// One named value per vertex, written where the format can hold it (ply, vtp).
struct VertexScalar {
  std::string name;
  std::vector<float> values;
};

/// Writes a mesh in world coordinates (LPS mm): binary little-endian PLY with normals, binary STL, OBJ, OFF, or VTK
/// PolyData XML. Coordinates are kept exactly, but for STL, which holds single precision. Whole or not at all.
/// Throws InputError for a mesh without triangles, with an index out of range or a vertex that is not finite,
/// OptionError for a scalar of another length or without a plain name, IoError.
void write_mesh(const TriMesh& mesh, const std::filesystem::path& path, MeshFormat format,
                std::span<const VertexScalar> scalars = {});

/// Reads PLY (ascii, binary little and big endian), STL (ascii, binary; equal corners welded), OBJ, OFF, told by the
/// name's ending. Faces with more corners are cut into a fan of triangles; normals, colours, textures and other
/// elements are left out. The triangles are those of the file, flat ones too.
/// Strict: cut short, declared longer than it is, an index out of range, a coordinate that is not finite, no triangle,
/// a text without its last line break: all refused. Only an OBJ cut at the end of a line cannot be told from a whole
/// one, because the format declares no counts.
/// Throws InputError naming the file and the line or byte, IoError when it cannot be read.
TriMesh read_mesh(const std::filesystem::path& path);

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

/// ParaView time series: entries of (time, file relative to the .pvd, part number).
struct PvdEntry {
  double time = 0;
  std::string file;
  int part = 0;
};
void write_pvd(std::span<const PvdEntry> entries, const std::filesystem::path& path);

}  // namespace dynasurf
