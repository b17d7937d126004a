#pragma once
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
/// PolyData XML. Whole or not at all. Throws IoError.
void write_mesh(const TriMesh& mesh, const std::filesystem::path& path, MeshFormat format,
                std::span<const VertexScalar> scalars = {});

/// Reads PLY (ascii, binary little and big endian), STL (ascii, binary; equal corners welded), OBJ, OFF, strictly.
/// Faces with more corners are cut into triangles. Throws InputError naming the file and the place, IoError.
TriMesh read_mesh(const std::filesystem::path& path);

/// The beating heart as one binary glTF: a node per surface, the first gate as base mesh and one morph target per
/// further gate, an animation over `cycle_s` seconds that returns to the start. LPS mm becomes metres, Y up.
struct AnimatedSurface {
  std::string name;
  std::array<float, 4> colour{1, 1, 1, 1};  // RGBA, linear
  std::vector<TriMesh> cycle;               // one mesh per gate, same triangles
};
void write_glb(std::span<const AnimatedSurface> surfaces, double cycle_s, const std::filesystem::path& path);

/// ParaView time series: entries of (time, file relative to the .pvd, part number).
struct PvdEntry {
  double time = 0;
  std::string file;
  int part = 0;
};
void write_pvd(std::span<const PvdEntry> entries, const std::filesystem::path& path);

}  // namespace dynasurf
