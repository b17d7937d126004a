#include "dynasurf/io/detail/gltf_scene.hpp"

#include <algorithm>

#include <meshoptimizer.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/bytes.hpp"

namespace dynasurf::io::detail {
namespace {

/// glTF counts bytes in 32 bits, and many readers take them for signed.
constexpr std::size_t max_glb_bytes = std::size_t{1} << 31;

/// Nameless things have no key for it.
GltfJson named(const std::string& name, GltfJson thing) {
  if (!name.empty()) thing["name"] = name;
  return thing;
}

GltfJson doubles_of(const auto& numbers) {
  GltfJson list = GltfJson::array();
  for (const auto number : numbers) list.push_back(static_cast<double>(number));
  return list;
}

/// Chunks begin and end at multiples of four.
std::string padded(std::string bytes, char filler) {
  bytes.resize((bytes.size() + 3) / 4 * 4, filler);
  return bytes;
}

void add_chunk(std::string& file, std::uint32_t kind, const std::string& bytes) {
  append(file, static_cast<std::uint32_t>(bytes.size()));
  append(file, kind);
  file += bytes;
}

}  // namespace

GltfScene::GltfScene() {
  document["asset"] = {{"version", "2.0"}, {"generator", "Dynasurf"}};
  document["scene"] = 0;
  document["scenes"] = GltfJson::array({GltfJson::object()});
}

// glTF asks for the bounds of positions (3.7.2.1) and of the times of an animation; elsewhere they are optional.
int GltfScene::add_rows(const Rows3& rows, bool with_bounds) {
  const int accessor =
      add_bytes(rows.data(), rows.size() * sizeof(rows[0]), rows.size(), "VEC3", gltf::float_32, gltf::array_buffer);
  if (with_bounds) {
    Eigen::Vector3f low = rows[0], high = rows[0];
    for (const auto& row : rows) {
      low = low.cwiseMin(row);
      high = high.cwiseMax(row);
    }
    set_bounds(accessor, low, high);
  }
  return accessor;
}

int GltfScene::add_triangles(const TriMesh& mesh) {
  return add_bytes(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]), 3 * mesh.triangles.size(),
                   "SCALAR", gltf::unsigned_int, gltf::element_array_buffer);
}

int GltfScene::add_pairs(const std::vector<Eigen::Vector2f>& rows) {
  return add_bytes(rows.data(), rows.size() * sizeof(rows[0]), rows.size(), "VEC2", gltf::float_32, gltf::array_buffer);
}

int GltfScene::add_fours(const std::vector<std::array<float, 4>>& rows) {
  return add_bytes(rows.data(), rows.size() * sizeof(rows[0]), rows.size(), "VEC4", gltf::float_32, gltf::array_buffer);
}

int GltfScene::add_colours(const std::vector<std::array<std::uint16_t, 4>>& colours) {
  const int accessor =
      add_bytes(colours.data(), 8 * colours.size(), colours.size(), "VEC4", gltf::unsigned_short, gltf::array_buffer);
  document["accessors"][accessor]["normalized"] = true;
  return accessor;
}

int GltfScene::add_values(const std::vector<float>& values) {
  return add_bytes(values.data(), values.size() * sizeof(float), values.size(), "SCALAR", gltf::float_32,
                   gltf::array_buffer);
}

int GltfScene::add_numbers(const std::vector<float>& numbers, bool with_bounds) {
  const int accessor =
      add_bytes(numbers.data(), numbers.size() * sizeof(float), numbers.size(), "SCALAR", gltf::float_32, 0);
  if (with_bounds) {
    const auto [low, high] = std::minmax_element(numbers.begin(), numbers.end());
    set_bounds(accessor, std::array{*low}, std::array{*high});
  }
  return accessor;
}

int GltfScene::add_packed_view(std::string_view packed, std::size_t stride, std::size_t count, const char* mode,
                               int target) {
  const std::size_t place = append_block(packed.data(), packed.size());
  GltfJson packing = {{"buffer", 0},          {"byteOffset", place}, {"byteLength", packed.size()},
                      {"byteStride", stride}, {"count", count},      {"mode", mode}};
  GltfJson view = {{"buffer", 1}, {"byteOffset", unpacked_}, {"byteLength", stride * count}, {"target", target}};
  if (target == gltf::array_buffer) view["byteStride"] = stride;
  view["extensions"] = {{"EXT_meshopt_compression", std::move(packing)}};
  unpacked_ += stride * count;
  return add("bufferViews", std::move(view));
}

int GltfScene::add_packed_rows(std::string_view rows, std::size_t stride, const char* type, int component,
                               bool normalized) {
  const std::size_t count = rows.size() / stride;
  std::string packed(meshopt_encodeVertexBufferBound(count, stride), '\0');
  packed.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(packed.data()), packed.size(), rows.data(),
                                           count, stride));
  const int view = add_packed_view(packed, stride, count, "ATTRIBUTES", gltf::array_buffer);
  GltfJson accessor = {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}};
  if (normalized) accessor["normalized"] = true;
  return add("accessors", std::move(accessor));
}

int GltfScene::add_packed_triangles(const std::vector<std::uint32_t>& corners) {
  const std::size_t vertices = std::size_t{*std::max_element(corners.begin(), corners.end())} + 1;
  std::string packed(meshopt_encodeIndexBufferBound(corners.size(), vertices), '\0');
  packed.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(packed.data()), packed.size(),
                                          corners.data(), corners.size()));
  const int view = add_packed_view(packed, sizeof(corners[0]), corners.size(), "TRIANGLES", gltf::element_array_buffer);
  return add(
      "accessors",
      {{"bufferView", view}, {"componentType", gltf::unsigned_int}, {"count", corners.size()}, {"type", "SCALAR"}});
}

int GltfScene::add_png(const std::string& png, const std::string& name) {
  const int view = add_view(png.data(), png.size(), 0);
  const int image = add("images", named(name, {{"mimeType", "image/png"}, {"bufferView", view}}));
  if (!document.contains("samplers"))  // no mipmaps: they would mix triangles that are neighbours in the picture alone
    add("samplers", {{"magFilter", gltf::linear},
                     {"minFilter", gltf::linear},
                     {"wrapS", gltf::clamp_to_edge},
                     {"wrapT", gltf::clamp_to_edge}});
  return add("textures", {{"sampler", 0}, {"source", image}});
}

int GltfScene::add_material(const std::string& name, double roughness) {
  GltfJson material = GltfJson::object();
  material["pbrMetallicRoughness"] = {{"metallicFactor", 0.0}, {"roughnessFactor", roughness}};
  return add("materials", named(name, std::move(material)));
}

int GltfScene::add_node(const std::string& name, GltfJson primitive, bool shown) {
  primitive["mode"] = gltf::triangles;
  GltfJson mesh = GltfJson::object(), node = GltfJson::object();
  mesh["primitives"] = GltfJson::array({std::move(primitive)});
  node["mesh"] = add("meshes", named(name, std::move(mesh)));
  const int index = add("nodes", named(name, std::move(node)));
  if (shown) shown_.push_back(index);
  return index;
}

std::string GltfScene::encode(const std::string& what) const {
  GltfJson whole = document;
  if (!shown_.empty()) whole["scenes"][0]["nodes"] = shown_;
  if (!binary_.empty()) whole["buffers"] = GltfJson::array({{{"byteLength", binary_.size()}}});
  if (unpacked_ > 0)
    whole["buffers"].push_back(
        {{"byteLength", unpacked_}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  // JSON is filled up by spaces, the buffer by zeros (GLB, 4.4.3).
  const std::string json = padded(whole.dump(-1, ' ', false, GltfJson::error_handler_t::replace), ' ');
  const std::string binary = padded(binary_, '\0');
  const std::size_t size = 12 + 8 + json.size() + (binary.empty() ? 0 : 8 + binary.size());
  if (size > 2 * max_glb_bytes - 1) throw InputError("cannot write " + what + ": does not fit one GLB file");
  std::string file;
  file.reserve(size);
  append(file, gltf::glb_magic);
  append(file, gltf::glb_version);
  append(file, static_cast<std::uint32_t>(size));
  add_chunk(file, gltf::json_chunk, json);
  if (!binary.empty()) add_chunk(file, gltf::binary_chunk, binary);
  return file;
}

int GltfScene::add(const char* list, GltfJson item) {
  GltfJson& items = *document.emplace(list, GltfJson::array()).first;
  items.push_back(std::move(item));
  return static_cast<int>(items.size()) - 1;
}

/// Gives the place where it stands.
std::size_t GltfScene::append_block(const void* data, std::size_t bytes) {
  if (binary_.size() + bytes > max_glb_bytes) throw InputError("the surfaces do not fit one GLB file of 2 GiB");
  binary_ = padded(std::move(binary_), '\0');  // each block begins aligned; only pictures and packed ones end elsewhere
  const std::size_t place = binary_.size();
  binary_.append(static_cast<const char*>(data), bytes);
  return place;
}

int GltfScene::add_view(const void* data, std::size_t bytes, int target) {
  const std::size_t place = append_block(data, bytes);
  GltfJson view = {{"buffer", 0}, {"byteLength", bytes}};
  if (place > 0) view["byteOffset"] = place;
  if (target != 0) view["target"] = target;
  return add("bufferViews", std::move(view));
}

int GltfScene::add_bytes(const void* data, std::size_t bytes, std::size_t count, const char* type, int component,
                         int target) {
  const int view = add_view(data, bytes, target);
  return add("accessors", {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
}

template <class Bounds>
void GltfScene::set_bounds(int accessor, const Bounds& low, const Bounds& high) {
  GltfJson& a = document["accessors"][accessor];
  a["min"] = doubles_of(low);
  a["max"] = doubles_of(high);
}

}  // namespace dynasurf::io::detail
