#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <tiny_gltf.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::io_detail {

using Rows3 = std::vector<Eigen::Vector3f>;

/// glTF counts bytes in 32 bits, and tinygltf casts to them.
constexpr std::size_t max_glb_bytes = std::size_t{1} << 31;

/// Collects numbers in the one buffer of the file; each block gets a view and an accessor of its own.
class GltfBuffer {
 public:
  explicit GltfBuffer(tinygltf::Model& model) : model_(model) { model_.buffers.emplace_back(); }

  int add_rows(const Rows3& rows, bool with_bounds) {
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

  int add_triangles(const TriMesh& mesh) {
    return add_bytes(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]),
                     3 * mesh.triangles.size(), TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                     TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  }

  int add_pairs(const std::vector<Eigen::Vector2f>& rows) {
    return add_bytes(rows.data(), rows.size() * sizeof(rows[0]), rows.size(), TINYGLTF_TYPE_VEC2,
                     TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER);
  }
  int add_fours(const std::vector<std::array<float, 4>>& rows) {
    return add_bytes(rows.data(), rows.size() * sizeof(rows[0]), rows.size(), TINYGLTF_TYPE_VEC4,
                     TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER);
  }

  /// A whole PNG file; gives the number of its texture.
  int add_png(const std::string& png, const std::string& name) {
    tinygltf::Image image;
    image.name = name;
    image.mimeType = "image/png";
    image.bufferView = add_view(png.data(), png.size(), 0);
    model_.images.push_back(image);
    if (model_.samplers.empty()) {
      tinygltf::Sampler sampler;  // no mipmaps: they would mix triangles that are neighbours in the picture alone
      sampler.minFilter = sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
      sampler.wrapS = sampler.wrapT = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
      model_.samplers.push_back(sampler);
    }
    tinygltf::Texture texture;
    texture.sampler = 0;
    texture.source = static_cast<int>(model_.images.size()) - 1;
    model_.textures.push_back(texture);
    return static_cast<int>(model_.textures.size()) - 1;
  }

  /// Linear red, green, blue and opacity, 0 to 65535: what glTF multiplies the material by.
  int add_colours(const std::vector<std::array<std::uint16_t, 4>>& colours) {
    const int accessor = add_bytes(colours.data(), 8 * colours.size(), colours.size(), TINYGLTF_TYPE_VEC4,
                                   TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TARGET_ARRAY_BUFFER);
    model_.accessors[static_cast<std::size_t>(accessor)].normalized = true;
    return accessor;
  }

  int add_numbers(const std::vector<float>& numbers, bool with_bounds) {
    const int accessor = add_bytes(numbers.data(), numbers.size() * sizeof(float), numbers.size(), TINYGLTF_TYPE_SCALAR,
                                   TINYGLTF_COMPONENT_TYPE_FLOAT, 0);
    if (with_bounds) {
      const auto [low, high] = std::minmax_element(numbers.begin(), numbers.end());
      set_bounds(accessor, std::array{*low}, std::array{*high});
    }
    return accessor;
  }

 private:
  int add_view(const void* data, std::size_t bytes, int target) {
    auto& all = model_.buffers[0].data;
    if (all.size() + bytes > max_glb_bytes) throw InputError("the surfaces do not fit one GLB file of 2 GiB");
    tinygltf::BufferView view;
    view.buffer = 0;
    all.resize((all.size() + 3) / 4 * 4);  // each block begins aligned; only pictures end elsewhere
    view.byteOffset = all.size();
    view.byteLength = bytes;
    view.target = target;
    const auto* begin = static_cast<const unsigned char*>(data);
    all.insert(all.end(), begin, begin + bytes);
    model_.bufferViews.push_back(view);
    return static_cast<int>(model_.bufferViews.size()) - 1;
  }

  int add_bytes(const void* data, std::size_t bytes, std::size_t count, int type, int component, int target) {
    tinygltf::Accessor accessor;
    accessor.bufferView = add_view(data, bytes, target);
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = count;
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  template <class Bounds>
  void set_bounds(int accessor, const Bounds& low, const Bounds& high) {
    auto& a = model_.accessors[static_cast<std::size_t>(accessor)];
    a.minValues.assign(low.begin(), low.end());
    a.maxValues.assign(high.begin(), high.end());
  }

  tinygltf::Model& model_;
};

}  // namespace dynasurf::io_detail
