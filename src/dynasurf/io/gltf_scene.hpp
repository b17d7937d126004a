#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <tiny_gltf.h>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::io_detail {

using Rows3 = std::vector<Eigen::Vector3f>;

/// A binary glTF in the making: one scene, and one buffer that holds all numbers, each block with a view and an
/// accessor of its own. The `add_` functions return the number by which the rest of the file names what was added.
/// They throw InputError where the buffer would leave the 2 GiB that the format can count.
class GltfScene {
 public:
  GltfScene();

  tinygltf::Model model;

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
  /// A whole PNG file; gives the number of its texture.
  int add_png(const std::string& png, const std::string& name);

  /// Matt, of one colour.
  int add_material(const std::string& name, double roughness);
  /// A node with a mesh of this one primitive, both of this name.
  int add_node(const std::string& name, tinygltf::Primitive primitive, bool shown);

  /// The whole file. `what` names the output. Throws IoError.
  std::string encode(const std::string& what);

 private:
  int add_view(const void* data, std::size_t bytes, int target);
  int add_bytes(const void* data, std::size_t bytes, std::size_t count, int type, int component, int target);
  template <class Bounds>
  void set_bounds(int accessor, const Bounds& low, const Bounds& high);
};

}  // namespace dynasurf::io_detail
