#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include <meshoptimizer.h>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/gltf_scene.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/detail/png.hpp"
#include "dynasurf/io/mesh_io.hpp"

namespace dynasurf::io {
namespace {

using detail::GltfJson;
using detail::GltfScene;
using detail::Rows3;

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
      // The transfer function of sRGB (IEC 61966-2-1), inverted.
      const double light = share <= 0.04045 ? share / 12.92 : own::pow((share + 0.055) / 1.055, 2.4);
      row[c] = std::lround(light * 65535);
    }
    row[3] = 65535;
  }
  return rows;
}

constexpr double roughness = 0.7;

/// glTF asks for the underscore.
std::string attribute_of(const VertexScalar& scalar) {
  std::string name = "_" + scalar.name;
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
  return name;
}

GltfJson plain_primitive(const TriMesh& mesh, const VertexColours& colours, std::span<const VertexScalar> scalars,
                         const Vec3& middle, GltfScene& scene) {
  Rows3 rows;
  rows.reserve(mesh.vertices.size());
  for (const Vec3& p : mesh.vertices) rows.push_back((p - middle).cast<float>());
  GltfJson primitive = {{"attributes", GltfJson::object()}};
  primitive["attributes"]["POSITION"] = scene.add_rows(rows, true);
  primitive["attributes"]["NORMAL"] = scene.add_rows(detail::normals_to_write(mesh), false);
  if (!colours.empty()) primitive["attributes"]["COLOR_0"] = scene.add_colours(linear(colours));
  for (const VertexScalar& scalar : scalars)
    primitive["attributes"][attribute_of(scalar)] = scene.add_values(scalar.values);
  primitive["indices"] = scene.add_triangles(mesh);
  return primitive;
}

/// Where the steps of 16 bits begin, and how long they are. All levels share them, so that a change of level moves
/// nothing.
struct Steps {
  Vec3 begin;
  double length;
};

Steps steps_of(std::span<const LodSurface> levels) {
  Eigen::AlignedBox3d box;
  for (const LodSurface& level : levels)
    for (const Vec3& p : level.mesh.vertices) box.extend(p);
  const double extent = box.sizes().maxCoeff();
  return {box.min(), extent > 0 ? extent / 65535 : 1};
}

/// Triangles in an order in which their corners come again soon, and vertices in the order of their first use: so they
/// pack best. The new number of each vertex, ~0 where no triangle has it.
std::vector<std::uint32_t> reorder(const TriMesh& mesh, std::vector<std::uint32_t>& corners) {
  for (const auto& triangle : mesh.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  meshopt_optimizeVertexCache(corners.data(), corners.data(), corners.size(), mesh.vertices.size());
  std::vector<std::uint32_t> number(mesh.vertices.size());
  meshopt_optimizeVertexFetchRemap(number.data(), corners.data(), corners.size(), mesh.vertices.size());
  for (std::uint32_t& corner : corners) corner = number[corner];
  return number;
}

/// One to four numbers of a vertex as an accessor of packed rows, in the new order of the vertices.
template <class T, std::size_t columns, class Row>
int add_packed(const std::vector<std::uint32_t>& number, int component, bool normalized, const Row& row_of,
               GltfScene& scene) {
  constexpr const char* types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  constexpr std::size_t stride = (columns * sizeof(T) + 3) / 4 * 4;
  constexpr std::uint32_t none = ~0u;
  const auto count = number.size() - static_cast<std::size_t>(std::count(number.begin(), number.end(), none));
  std::string rows(count * stride, '\0');
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == none) continue;
    const std::array<T, columns> row = row_of(v);
    std::memcpy(rows.data() + number[v] * stride, row.data(), sizeof row);
  }
  return scene.add_packed_rows(rows, stride, types[columns - 1], component, normalized);
}

/// Shares of 1 take 16 bits, others what they had.
int add_packed_scalar(const std::vector<float>& values, const std::vector<std::uint32_t>& number, GltfScene& scene) {
  namespace gltf = detail::gltf;
  if (std::all_of(values.begin(), values.end(), [](float v) { return v >= 0 && v <= 1; }))
    return add_packed<std::uint16_t, 1>(
        number, gltf::unsigned_short, true,
        [&](std::size_t v) { return std::array{static_cast<std::uint16_t>(std::lround(65535.0 * values[v]))}; }, scene);
  return add_packed<float, 1>(
      number, gltf::float_32, false, [&](std::size_t v) { return std::array{values[v]}; }, scene);
}

GltfJson packed_primitive(const LodSurface& level, const Steps& steps, GltfScene& scene) {
  namespace gltf = detail::gltf;
  std::vector<std::uint32_t> corners;
  const std::vector<std::uint32_t> number = reorder(level.mesh, corners);
  GltfJson primitive = {{"attributes", GltfJson::object()}};
  GltfJson& attributes = primitive["attributes"];
  std::array<std::uint16_t, 3> low{65535, 65535, 65535}, high{};
  attributes["POSITION"] = add_packed<std::uint16_t, 3>(
      number, gltf::unsigned_short, false,
      [&](std::size_t v) {
        const Vec3 place = (level.mesh.vertices[v] - steps.begin) / steps.length;
        std::array<std::uint16_t, 3> row{};
        for (std::size_t c = 0; c < 3; ++c) {
          row[c] = static_cast<std::uint16_t>(std::lround(place[static_cast<Eigen::Index>(c)]));
          low[c] = std::min(low[c], row[c]);
          high[c] = std::max(high[c], row[c]);
        }
        return row;
      },
      scene);
  scene.document["accessors"].back()["min"] = low;
  scene.document["accessors"].back()["max"] = high;
  const Rows3 normals = detail::normals_to_write(level.mesh);
  attributes["NORMAL"] = add_packed<std::int8_t, 3>(
      number, gltf::signed_byte, true,
      [&](std::size_t v) {
        std::array<std::int8_t, 3> row{};
        for (std::size_t c = 0; c < 3; ++c)
          row[c] = static_cast<std::int8_t>(std::lround(127 * normals[v][static_cast<Eigen::Index>(c)]));
        return row;
      },
      scene);
  if (!level.colours.empty()) {
    const auto light = linear(level.colours);
    attributes["COLOR_0"] = add_packed<std::uint16_t, 4>(
        number, gltf::unsigned_short, true, [&](std::size_t v) { return light[v]; }, scene);
  }
  for (const VertexScalar& scalar : level.scalars)
    attributes[attribute_of(scalar)] = add_packed_scalar(scalar.values, number, scene);
  primitive["indices"] = scene.add_packed_triangles(corners);
  return primitive;
}

/// A node whose places are seen from `middle`, so that places far from the origin keep their precision.
void add_node_at(const Vec3& middle, const std::string& name, GltfJson primitive, bool shown, GltfScene& scene) {
  scene.add_node(name, std::move(primitive), shown);
  scene.document["nodes"].back()["translation"] = {middle[0], middle[1], middle[2]};
}

GltfJson textured_primitive(const mesh::TexturedMesh& mesh, const Vec3& middle, GltfScene& scene) {
  Rows3 places, normals;
  std::vector<std::array<float, 4>> tangents;
  std::vector<Eigen::Vector2f> uvs;
  for (const mesh::TexturedMesh::Corner& c : mesh.corners) {
    places.push_back((c.position - middle).cast<float>());
    normals.push_back(c.normal);
    tangents.push_back({c.tangent[0], c.tangent[1], c.tangent[2], 1.0F});
    uvs.push_back(c.uv);
  }
  GltfJson primitive = {{"attributes", GltfJson::object()}};
  primitive["attributes"]["POSITION"] = scene.add_rows(places, true);
  primitive["attributes"]["NORMAL"] = scene.add_rows(normals, false);
  primitive["attributes"]["TANGENT"] = scene.add_fours(tangents);
  primitive["attributes"]["TEXCOORD_0"] = scene.add_pairs(uvs);
  return primitive;
}

std::string png_of(const mesh::Texture& texture) {
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
  GltfJson& material = scene.document["materials"].back();
  material["normalTexture"] = {{"index", normals}};
  if (coloured) material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", colours}};
  return index;
}

bool is_textured(const LodSurface& level) { return !level.textured.corners.empty(); }

void check_textures(const LodSurface& level, const std::string& what) {
  const auto fits = [](const mesh::Texture& t) {
    return t.width > 0 && t.height > 0 && t.texels.size() == t.width * static_cast<std::size_t>(t.height);
  };
  const mesh::TexturedMesh& mesh = level.textured;
  if (mesh.corners.size() % 3 != 0 || !fits(mesh.normals) || (!mesh.colours.texels.empty() && !fits(mesh.colours)))
    throw InputError("cannot write " + what + ": the textures of " + level.name + " do not fit their corners");
}

/// The finest node lists the others, and down to which part of the screen each level serves.
void name_levels(std::span<const LodSurface> levels, GltfJson& document) {
  if (levels.size() < 2) return;
  GltfJson ids = GltfJson::array(), coverage = GltfJson::array();
  for (std::size_t n = 0; n < levels.size(); ++n) {
    if (n > 0) ids.push_back(n);
    coverage.push_back(levels[n].smallest_coverage);
  }
  GltfJson& finest = document["nodes"][0];
  finest["extras"] = {{"MSFT_screencoverage", std::move(coverage)}};
  finest["extensions"] = {{"MSFT_lod", {{"ids", std::move(ids)}}}};
  document.emplace("extensionsUsed", GltfJson::array()).first->push_back("MSFT_lod");
}

void check_levels(std::span<const LodSurface> levels, const std::string& what) {
  if (levels.empty()) throw InputError("cannot write " + what + ": there is no level");
  for (const LodSurface& level : levels) {
    detail::check_writable(level.mesh, level.scalars, what);
    detail::check_colours(level.mesh, level.colours, what);
    if (is_textured(level)) check_textures(level, what);
  }
}

}  // namespace

void write_lod_glb(std::span<const LodSurface> levels, const std::filesystem::path& path) {
  check_levels(levels, path.string());
  GltfScene scene;
  const bool all_textured = std::all_of(levels.begin(), levels.end(), is_textured);
  const int plain = all_textured ? -1 : scene.add_material("surface", roughness);
  // All levels are seen from one place, so that a change of level moves nothing.
  const Vec3 middle = middle_of(levels[0].mesh);
  for (const LodSurface& level : levels) {
    GltfJson primitive = is_textured(level) ? textured_primitive(level.textured, middle, scene)
                                            : plain_primitive(level.mesh, level.colours, level.scalars, middle, scene);
    primitive["material"] = is_textured(level) ? add_textured_material(level, scene) : plain;
    // MSFT_lod names the coarser nodes; in the scene itself they would be drawn over the finest.
    add_node_at(middle, level.name, std::move(primitive), &level == &levels[0], scene);
  }
  name_levels(levels, scene.document);
  write_file(path, scene.encode(path.string()));
}

void write_packed_lod_glb(std::span<const LodSurface> levels, const std::filesystem::path& path) {
  check_levels(levels, path.string());
  GltfScene scene;
  scene.document["extensionsUsed"] = {"EXT_meshopt_compression", "KHR_mesh_quantization"};
  scene.document["extensionsRequired"] = scene.document["extensionsUsed"];
  const int material = scene.add_material("surface", roughness);
  const Steps steps = steps_of(levels);
  for (const LodSurface& level : levels) {
    GltfJson primitive = packed_primitive(level, steps, scene);
    primitive["material"] = material;
    add_node_at(steps.begin, level.name, std::move(primitive), &level == &levels[0], scene);
    scene.document["nodes"].back()["scale"] = {steps.length, steps.length, steps.length};
  }
  name_levels(levels, scene.document);
  write_file(path, scene.encode(path.string()));
}

std::string detail::encode_glb(const TriMesh& mesh, std::span<const VertexScalar> scalars, const VertexColours& colours,
                               const std::string& what) {
  GltfScene scene;
  const Vec3 middle = middle_of(mesh);
  GltfJson primitive = plain_primitive(mesh, colours, scalars, middle, scene);
  primitive["material"] = scene.add_material("surface", roughness);
  add_node_at(middle, "surface", std::move(primitive), true, scene);
  return scene.encode(what);
}

}  // namespace dynasurf::io
