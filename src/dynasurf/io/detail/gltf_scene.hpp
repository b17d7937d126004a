#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "dynasurf/core/tri_mesh.hpp"

// The numbers that glTF 2.0 gives to the kinds of things that we write and read.
namespace dynasurf::io::detail::gltf {

inline constexpr int signed_byte = 5120, unsigned_short = 5123, unsigned_int = 5125, float_32 = 5126;
inline constexpr int array_buffer = 34962, element_array_buffer = 34963;
inline constexpr int linear = 9729, clamp_to_edge = 33071;
inline constexpr int triangles = 4;
inline constexpr std::uint32_t glb_magic = 0x46546c67, glb_version = 2;
inline constexpr std::uint32_t json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;

}  // namespace dynasurf::io::detail::gltf

namespace dynasurf::io::detail {

using Rows3 = std::vector<Eigen::Vector3f>;
/// Keys stand in alphabetical order.
using GltfJson = nlohmann::json;

/// A binary glTF in the making: one scene, and one buffer that holds all numbers, each block with a view and an
/// accessor of its own. The `add_` functions return the number by which the rest of the file names what was added.
/// They throw InputError where the buffer would leave the 2 GiB that the format can count.
class GltfScene {
 public:
  GltfScene();

  GltfJson document = GltfJson::object();

  int add_rows(const Rows3& rows, bool with_bounds);
  int add_triangles(const TriMesh& mesh);
  int add_pairs(const std::vector<Eigen::Vector2f>& rows);
  int add_fours(const std::vector<std::array<float, 4>>& rows);
  /// Linear red, green, blue and opacity, 0 to 65535: what glTF multiplies the material by.
  int add_colours(const std::vector<std::array<std::uint16_t, 4>>& colours);
  /// One for each vertex.
  int add_values(const std::vector<float>& values);
  /// Of an animation.
  int add_numbers(const std::vector<float>& numbers, bool with_bounds);
  /// `count` rows of `stride` bytes, a multiple of 4, packed by meshoptimizer (EXT_meshopt_compression); an accessor
  /// takes what `type` and `component` tell of each.
  int add_packed_rows(std::string_view rows, std::size_t stride, const char* type, int component, bool normalized);
  /// The corners of triangles, packed too.
  int add_packed_triangles(const std::vector<std::uint32_t>& corners);
  /// A whole PNG file; gives the number of its texture.
  int add_png(const std::string& png, const std::string& name);

  /// Matt, of one colour.
  int add_material(const std::string& name, double roughness);
  /// A node with a mesh of this one primitive, both of this name.
  int add_node(const std::string& name, GltfJson primitive, bool shown);

  /// The whole file. `what` names the output. Throws InputError for one too large for the format.
  std::string encode(const std::string& what) const;

 private:
  std::string binary_;
  std::size_t unpacked_ = 0;  // bytes of what is packed: of a buffer that no file holds
  std::vector<int> shown_;    // nodes of the scene

  int add(const char* list, GltfJson item);
  std::size_t append_block(const void* data, std::size_t bytes);
  int add_view(const void* data, std::size_t bytes, int target);
  int add_packed_view(std::string_view packed, std::size_t stride, std::size_t count, const char* mode, int target);
  int add_bytes(const void* data, std::size_t bytes, std::size_t count, const char* type, int component, int target);
  template <class Bounds>
  void set_bounds(int accessor, const Bounds& low, const Bounds& high);
};

}  // namespace dynasurf::io::detail
