#include "dynasurf/io/gltf_scene.hpp"

#include <algorithm>
#include <sstream>

#include "dynasurf/core/error.hpp"

namespace dynasurf::io_detail {
namespace {

/// glTF counts bytes in 32 bits, and tinygltf casts to them.
constexpr std::size_t max_glb_bytes = std::size_t{1} << 31;

}  // namespace

GltfScene::GltfScene() {
  model.asset.version = "2.0";
  model.asset.generator = "Dynasurf";
  model.buffers.emplace_back();
  model.scenes.emplace_back();
  model.defaultScene = 0;
}

int GltfScene::add_rows(const Rows3& rows, bool with_bounds) {
  const int accessor = add_bytes(rows.data(), rows.size() * sizeof(rows[0]), rows.size(), TINYGLTF_TYPE_VEC3,
                                 TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER);
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
                   TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
}

int GltfScene::add_pairs(const std::vector<Eigen::Vector2f>& rows) {
  return add_bytes(rows.data(), rows.size() * sizeof(rows[0]), rows.size(), TINYGLTF_TYPE_VEC2,
                   TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER);
}

int GltfScene::add_fours(const std::vector<std::array<float, 4>>& rows) {
  return add_bytes(rows.data(), rows.size() * sizeof(rows[0]), rows.size(), TINYGLTF_TYPE_VEC4,
                   TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER);
}

int GltfScene::add_colours(const std::vector<std::array<std::uint16_t, 4>>& colours) {
  const int accessor = add_bytes(colours.data(), 8 * colours.size(), colours.size(), TINYGLTF_TYPE_VEC4,
                                 TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TARGET_ARRAY_BUFFER);
  model.accessors[static_cast<std::size_t>(accessor)].normalized = true;
  return accessor;
}

int GltfScene::add_values(const std::vector<float>& values) {
  return add_bytes(values.data(), values.size() * sizeof(float), values.size(), TINYGLTF_TYPE_SCALAR,
                   TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER);
}

int GltfScene::add_numbers(const std::vector<float>& numbers, bool with_bounds) {
  const int accessor = add_bytes(numbers.data(), numbers.size() * sizeof(float), numbers.size(), TINYGLTF_TYPE_SCALAR,
                                 TINYGLTF_COMPONENT_TYPE_FLOAT, 0);
  if (with_bounds) {
    const auto [low, high] = std::minmax_element(numbers.begin(), numbers.end());
    set_bounds(accessor, std::array{*low}, std::array{*high});
  }
  return accessor;
}

int GltfScene::add_png(const std::string& png, const std::string& name) {
  tinygltf::Image image;
  image.name = name;
  image.mimeType = "image/png";
  image.bufferView = add_view(png.data(), png.size(), 0);
  model.images.push_back(image);
  if (model.samplers.empty()) {
    tinygltf::Sampler sampler;  // no mipmaps: they would mix triangles that are neighbours in the picture alone
    sampler.minFilter = sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.wrapS = sampler.wrapT = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    model.samplers.push_back(sampler);
  }
  tinygltf::Texture texture;
  texture.sampler = 0;
  texture.source = static_cast<int>(model.images.size()) - 1;
  model.textures.push_back(texture);
  return static_cast<int>(model.textures.size()) - 1;
}

int GltfScene::add_material(const std::string& name, double roughness) {
  tinygltf::Material material;
  material.name = name;
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = roughness;
  model.materials.push_back(material);
  return static_cast<int>(model.materials.size()) - 1;
}

int GltfScene::add_node(const std::string& name, tinygltf::Primitive primitive, bool shown) {
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  tinygltf::Mesh mesh;
  mesh.name = name;
  mesh.primitives.push_back(std::move(primitive));
  model.meshes.push_back(std::move(mesh));
  tinygltf::Node node;
  node.name = name;
  node.mesh = static_cast<int>(model.meshes.size()) - 1;
  const int index = static_cast<int>(model.nodes.size());
  model.nodes.push_back(std::move(node));
  if (shown) model.scenes[0].nodes.push_back(index);
  return index;
}

std::string GltfScene::encode(const std::string& what) {
  std::ostringstream bytes;
  if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, bytes, false, true))
    throw IoError("cannot write " + what + ": glTF could not be put together");
  return bytes.str();
}

int GltfScene::add_view(const void* data, std::size_t bytes, int target) {
  auto& all = model.buffers[0].data;
  if (all.size() + bytes > max_glb_bytes) throw InputError("the surfaces do not fit one GLB file of 2 GiB");
  tinygltf::BufferView view;
  view.buffer = 0;
  all.resize((all.size() + 3) / 4 * 4);  // each block begins aligned; only pictures end elsewhere
  view.byteOffset = all.size();
  view.byteLength = bytes;
  view.target = target;
  const auto* begin = static_cast<const unsigned char*>(data);
  all.insert(all.end(), begin, begin + bytes);
  model.bufferViews.push_back(view);
  return static_cast<int>(model.bufferViews.size()) - 1;
}

int GltfScene::add_bytes(const void* data, std::size_t bytes, std::size_t count, int type, int component, int target) {
  tinygltf::Accessor accessor;
  accessor.bufferView = add_view(data, bytes, target);
  accessor.componentType = component;
  accessor.type = type;
  accessor.count = count;
  model.accessors.push_back(accessor);
  return static_cast<int>(model.accessors.size()) - 1;
}

template <class Bounds>
void GltfScene::set_bounds(int accessor, const Bounds& low, const Bounds& high) {
  auto& a = model.accessors[static_cast<std::size_t>(accessor)];
  a.minValues.assign(low.begin(), low.end());
  a.maxValues.assign(high.begin(), high.end());
}

}  // namespace dynasurf::io_detail
