#include <algorithm>
#include <cmath>
#include <sstream>

#include "dynasurf/io/atomic_file.hpp"
#include "dynasurf/io/gltf_buffer.hpp"
#include "dynasurf/io/mesh_formats.hpp"
#include "dynasurf/io/png.hpp"

namespace dynasurf {
namespace {

using io_detail::GltfBuffer;
using io_detail::Rows3;

Vec3 middle_of(const TriMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : mesh.vertices) box.extend(p);
  return box.center();
}

/// glTF's vertex colours are linear, so 16 bits keep what 8 bits of sRGB tell apart.
std::vector<std::array<std::uint16_t, 4>> linear(const VertexColours& colours) {
  std::vector<std::array<std::uint16_t, 4>> rows;
  rows.reserve(colours.size());
  for (const auto& colour : colours) {
    auto& row = rows.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      const double share = colour[c] / 255.0;
      const double light = share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
      row[c] = static_cast<std::uint16_t>(std::lround(light * 65535));
    }
    row[3] = 65535;
  }
  return rows;
}

tinygltf::Primitive plain_primitive(const LodSurface& level, const Vec3& middle, GltfBuffer& buffer) {
  Rows3 rows;
  rows.reserve(level.mesh.vertices.size());
  for (const Vec3& p : level.mesh.vertices) rows.push_back((p - middle).cast<float>());
  tinygltf::Primitive primitive;
  primitive.attributes["POSITION"] = buffer.add_rows(rows, true);
  primitive.attributes["NORMAL"] = buffer.add_rows(io_detail::vertex_normals(level.mesh), false);
  if (!level.colours.empty()) primitive.attributes["COLOR_0"] = buffer.add_colours(linear(level.colours));
  primitive.indices = buffer.add_triangles(level.mesh);
  return primitive;
}

tinygltf::Primitive textured_primitive(const TexturedMesh& mesh, const Vec3& middle, GltfBuffer& buffer) {
  Rows3 places, normals;
  std::vector<std::array<float, 4>> tangents;
  std::vector<Eigen::Vector2f> uvs;
  for (const TexturedMesh::Corner& c : mesh.corners) {
    places.push_back((c.position - middle).cast<float>());
    normals.push_back(c.normal);
    tangents.push_back({c.tangent[0], c.tangent[1], c.tangent[2], 1.0F});
    uvs.push_back(c.uv);
  }
  tinygltf::Primitive primitive;
  primitive.attributes["POSITION"] = buffer.add_rows(places, true);
  primitive.attributes["NORMAL"] = buffer.add_rows(normals, false);
  primitive.attributes["TANGENT"] = buffer.add_fours(tangents);
  primitive.attributes["TEXCOORD_0"] = buffer.add_pairs(uvs);
  return primitive;
}

std::string png_of(const Texture& texture) {
  Picture picture;
  picture.width = texture.width;
  picture.height = texture.height;
  picture.pixels = texture.texels;
  return encode_png(picture);
}

tinygltf::Material plain_material(const std::string& name) {
  tinygltf::Material material;
  material.name = name;
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = 0.7;
  return material;
}

tinygltf::Material textured_material(const LodSurface& level, GltfBuffer& buffer) {
  tinygltf::Material material = plain_material(level.name);
  material.normalTexture.index = buffer.add_png(png_of(level.textured.normals), level.name + "_normals");
  if (!level.textured.colours.texels.empty())
    material.pbrMetallicRoughness.baseColorTexture.index =
        buffer.add_png(png_of(level.textured.colours), level.name + "_colours");
  return material;
}

bool is_textured(const LodSurface& level) { return !level.textured.corners.empty(); }

void check_textures(const LodSurface& level, const std::string& what) {
  const auto fits = [](const Texture& t) {
    return t.width > 0 && t.height > 0 &&
           t.texels.size() == static_cast<std::size_t>(t.width) * static_cast<std::size_t>(t.height);
  };
  const TexturedMesh& mesh = level.textured;
  if (mesh.corners.size() % 3 != 0 || !fits(mesh.normals) || (!mesh.colours.texels.empty() && !fits(mesh.colours)))
    throw InputError("cannot write " + what + ": the textures of " + level.name + " do not fit their corners");
}

tinygltf::Mesh mesh_of(const LodSurface& level, const Vec3& middle, tinygltf::Model& model, GltfBuffer& buffer) {
  tinygltf::Primitive primitive =
      is_textured(level) ? textured_primitive(level.textured, middle, buffer) : plain_primitive(level, middle, buffer);
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = is_textured(level) ? static_cast<int>(model.materials.size()) : 0;
  if (is_textured(level)) model.materials.push_back(textured_material(level, buffer));
  tinygltf::Mesh mesh;
  mesh.name = level.name;
  mesh.primitives.push_back(primitive);
  return mesh;
}

/// The finest node lists the others, and down to which part of the screen each level serves.
void name_levels(std::span<const LodSurface> levels, tinygltf::Model& model) {
  if (levels.size() < 2) return;
  std::vector<tinygltf::Value> ids, coverage;
  for (std::size_t n = 0; n < levels.size(); ++n) {
    if (n > 0) ids.emplace_back(static_cast<int>(n));
    coverage.emplace_back(levels[n].smallest_coverage);
  }
  model.nodes[0].extensions["MSFT_lod"] = tinygltf::Value({{"ids", tinygltf::Value(ids)}});
  model.nodes[0].extras = tinygltf::Value({{"MSFT_screencoverage", tinygltf::Value(coverage)}});
  model.extensionsUsed.emplace_back("MSFT_lod");
}

}  // namespace

void write_lod_glb(std::span<const LodSurface> levels, const std::filesystem::path& path) {
  if (levels.empty()) throw InputError("cannot write " + path.string() + ": there is no level");
  for (const LodSurface& level : levels) {
    io_detail::check_writable(level.mesh, {}, path.string());
    io_detail::check_colours(level.mesh, level.colours, path.string());
    if (is_textured(level)) check_textures(level, path.string());
  }
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "Dynasurf";
  if (!std::all_of(levels.begin(), levels.end(), is_textured)) model.materials.push_back(plain_material("surface"));
  GltfBuffer buffer(model);
  const Vec3 middle = middle_of(levels[0].mesh);
  for (const LodSurface& level : levels) {
    tinygltf::Node node;
    node.name = level.name;
    node.mesh = static_cast<int>(model.meshes.size());
    node.translation = {middle[0], middle[1], middle[2]};
    model.meshes.push_back(mesh_of(level, middle, model, buffer));
    model.nodes.push_back(node);
  }
  name_levels(levels, model);
  tinygltf::Scene scene;
  scene.nodes.push_back(0);
  model.scenes.push_back(scene);
  model.defaultScene = 0;

  std::ostringstream bytes;
  if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, bytes, false, true))
    throw IoError("cannot write " + path.string() + ": glTF could not be put together");
  write_file(path, bytes.str());
}

}  // namespace dynasurf
