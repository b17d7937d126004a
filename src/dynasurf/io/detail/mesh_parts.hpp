#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/mesh/detail/textured_mesh.hpp"

// What the readers and writers of meshes and clouds share with their formats.
namespace dynasurf::io {

/// The formats of triangle meshes that are written.
enum class MeshFormat { ply, stl, obj, off, vtp, glb, threemf };
std::span<const std::string_view> names_of(MeshFormat);

/// One named value per vertex, written where the format can hold it (ply, vtp, and glb as the attribute _NAME).
struct VertexScalar {
  std::string name;
  std::vector<float> values;
};

/// sRGB, one per vertex, or none.
using VertexColours = std::vector<std::array<std::uint8_t, 3>>;

/// A level of detail.
struct LodSurface {
  std::string name;
  TriMesh mesh;
  VertexColours colours;
  double smallest_coverage = 0;  // part of the screen's height that the object takes when the next level takes over
  /// Written instead of `mesh` and `colours` when it has corners, with its textures as PNG.
  mesh::TexturedMesh textured;
  std::vector<VertexScalar> scalars = {};  // as the attributes _NAME; not written with textures
};

/// What a file of a cloud was.
struct CloudSource {
  std::string format;         // "PLY", "XYZ", "LAS", ...
  std::size_t points = 0;     // that it gave
  std::size_t triangles = 0;  // of the surface that was sampled; 0: it was a cloud
};

/// Points that a surface given as input is sampled to, its vertices among them; more when it has more vertices.
constexpr std::size_t points_of_a_surface = 100'000;

}  // namespace dynasurf::io
