#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/atomic_file.hpp"
#include "dynasurf/io/byte_source.hpp"
#include "dynasurf/io/gltf_scene.hpp"
#include "dynasurf/io/mesh_formats.hpp"
#include "dynasurf/io/png.hpp"

namespace dynasurf {
namespace {

using io_detail::GltfScene;
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

constexpr double roughness = 0.7;

tinygltf::Primitive plain_primitive(const TriMesh& mesh, const VertexColours& colours, const Vec3& middle,
                                    GltfScene& scene) {
  Rows3 rows;
  rows.reserve(mesh.vertices.size());
  for (const Vec3& p : mesh.vertices) rows.push_back((p - middle).cast<float>());
  tinygltf::Primitive primitive;
  primitive.attributes["POSITION"] = scene.add_rows(rows, true);
  primitive.attributes["NORMAL"] = scene.add_rows(io_detail::vertex_normals(mesh), false);
  if (!colours.empty()) primitive.attributes["COLOR_0"] = scene.add_colours(linear(colours));
  primitive.indices = scene.add_triangles(mesh);
  return primitive;
}

/// A node whose places are seen from `middle`, so that places far from the origin keep their precision.
void add_node_at(const Vec3& middle, const std::string& name, tinygltf::Primitive primitive, bool shown,
                 GltfScene& scene) {
  scene.add_node(name, std::move(primitive), shown);
  scene.model.nodes.back().translation = {middle[0], middle[1], middle[2]};
}

tinygltf::Primitive textured_primitive(const TexturedMesh& mesh, const Vec3& middle, GltfScene& scene) {
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
  primitive.attributes["POSITION"] = scene.add_rows(places, true);
  primitive.attributes["NORMAL"] = scene.add_rows(normals, false);
  primitive.attributes["TANGENT"] = scene.add_fours(tangents);
  primitive.attributes["TEXCOORD_0"] = scene.add_pairs(uvs);
  return primitive;
}

std::string png_of(const Texture& texture) {
  Picture picture;
  picture.width = texture.width;
  picture.height = texture.height;
  picture.pixels = texture.texels;
  return encode_png(picture);
}

int add_textured_material(const LodSurface& level, GltfScene& scene) {
  const int normals = scene.add_png(png_of(level.textured.normals), level.name + "_normals");
  const bool coloured = !level.textured.colours.texels.empty();
  const int colours = coloured ? scene.add_png(png_of(level.textured.colours), level.name + "_colours") : -1;
  const int index = scene.add_material(level.name, roughness);
  scene.model.materials.back().normalTexture.index = normals;
  scene.model.materials.back().pbrMetallicRoughness.baseColorTexture.index = colours;  // -1: none
  return index;
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

[[noreturn]] void refuse(const std::string& file) {
  throw InputError(file + ": is not a file of levels of detail that this program wrote");
}

/// The numbers of an accessor of this kind: `width` of `bytes` bytes in each of its rows.
template <class Number>
std::vector<Number> numbers_of(const tinygltf::Model& model, int accessor, int type, int component, std::size_t width,
                               const std::string& file) {
  constexpr std::size_t max_count = std::size_t{1} << 32;
  const auto is_one_of = [](int index, const auto& all) {
    return index >= 0 && static_cast<std::size_t>(index) < all.size();
  };
  if (is_one_of(accessor, model.accessors)) {
    const tinygltf::Accessor& a = model.accessors[static_cast<std::size_t>(accessor)];
    if (a.type == type && a.componentType == component && is_one_of(a.bufferView, model.bufferViews)) {
      const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(a.bufferView)];
      const std::size_t bytes = a.count * width * sizeof(Number), begin = view.byteOffset + a.byteOffset;
      if (is_one_of(view.buffer, model.buffers) && view.byteStride == 0 && a.count < max_count &&
          begin + bytes <= model.buffers[static_cast<std::size_t>(view.buffer)].data.size()) {
        std::vector<Number> numbers(a.count * width);
        std::memcpy(numbers.data(), &model.buffers[static_cast<std::size_t>(view.buffer)].data[begin], bytes);
        return numbers;
      }
    }
  }
  refuse(file);
}

LodSurface level_of(const tinygltf::Model& model, const tinygltf::Node& node, const std::string& file) {
  if (node.mesh < 0 || static_cast<std::size_t>(node.mesh) >= model.meshes.size() || node.translation.size() != 3 ||
      model.meshes[static_cast<std::size_t>(node.mesh)].primitives.size() != 1)
    refuse(file);
  const tinygltf::Primitive& primitive = model.meshes[static_cast<std::size_t>(node.mesh)].primitives[0];
  if (primitive.attributes.contains("TEXCOORD_0"))
    throw InputError(file + ": " + node.name +
                     " is textured, and its triangles share no vertices; expected plain ones");
  const auto place = primitive.attributes.find("POSITION");
  const auto places = numbers_of<float>(model, place == primitive.attributes.end() ? -1 : place->second,
                                        TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT, 3, file);
  const auto corners = numbers_of<std::uint32_t>(model, primitive.indices, TINYGLTF_TYPE_SCALAR,
                                                 TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, 1, file);
  LodSurface level;
  level.name = node.name;
  const Vec3 middle(node.translation[0], node.translation[1], node.translation[2]);
  for (std::size_t i = 0; i + 2 < places.size(); i += 3)
    level.mesh.vertices.push_back(Eigen::Vector3f(places[i], places[i + 1], places[i + 2]).cast<double>() + middle);
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    level.mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  const bool is_whole =
      std::all_of(corners.begin(), corners.end(), [&](auto v) { return 3 * std::size_t{v} < places.size(); });
  if (!is_whole || corners.empty() || corners.size() % 3 != 0) refuse(file);
  return level;
}

}  // namespace

std::vector<LodSurface> read_lod_glb(const std::filesystem::path& path) {
  const std::string bytes = text_of_file(path);
  tinygltf::Model model;
  std::string error, warning;
  if (!tinygltf::TinyGLTF().LoadBinaryFromMemory(&model, &error, &warning,
                                                 reinterpret_cast<const unsigned char*>(bytes.data()),
                                                 static_cast<unsigned int>(bytes.size())) ||
      model.nodes.empty())
    refuse(path.string());
  std::vector<LodSurface> levels;
  for (const tinygltf::Node& node : model.nodes) levels.push_back(level_of(model, node, path.string()));
  return levels;
}

void write_lod_glb(std::span<const LodSurface> levels, const std::filesystem::path& path) {
  if (levels.empty()) throw InputError("cannot write " + path.string() + ": there is no level");
  for (const LodSurface& level : levels) {
    io_detail::check_writable(level.mesh, {}, path.string());
    io_detail::check_colours(level.mesh, level.colours, path.string());
    if (is_textured(level)) check_textures(level, path.string());
  }
  GltfScene scene;
  const bool all_textured = std::all_of(levels.begin(), levels.end(), is_textured);
  const int plain = all_textured ? -1 : scene.add_material("surface", roughness);
  const Vec3 middle = middle_of(levels[0].mesh);
  for (const LodSurface& level : levels) {
    tinygltf::Primitive primitive = is_textured(level) ? textured_primitive(level.textured, middle, scene)
                                                       : plain_primitive(level.mesh, level.colours, middle, scene);
    primitive.material = is_textured(level) ? add_textured_material(level, scene) : plain;
    add_node_at(middle, level.name, std::move(primitive), &level == &levels[0], scene);
  }
  name_levels(levels, scene.model);
  write_file(path, scene.encode(path.string()));
}

std::string io_detail::encode_glb(const TriMesh& mesh, std::span<const VertexScalar> scalars,
                                  const VertexColours& colours, const std::string& what) {
  GltfScene scene;
  const Vec3 middle = middle_of(mesh);
  tinygltf::Primitive primitive = plain_primitive(mesh, colours, middle, scene);
  primitive.material = scene.add_material("surface", roughness);
  for (const VertexScalar& scalar : scalars) {
    std::string name = "_" + scalar.name;  // glTF asks for the underscore
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
    primitive.attributes[name] = scene.add_values(scalar.values);
  }
  add_node_at(middle, "surface", std::move(primitive), true, scene);
  return scene.encode(what);
}

}  // namespace dynasurf
