#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "dynasurf/core/grid.hpp"

namespace dynasurf::mesh {

/// A picture whose rows run from the top.
struct Texture {
  int width = 0, height = 0;
  std::vector<std::array<std::uint8_t, 3>> texels;
};

/// A mesh cut into its triangles, each with a place of its own in its textures: corner 3 t + i is corner i of triangle
/// t.
struct TexturedMesh {
  struct Corner {
    Vec3 position;
    Eigen::Vector3f normal, tangent;  // unit; the bitangent is their cross product
    Eigen::Vector2f uv;               // from the top left, in parts of the texture
  };
  std::vector<Corner> corners;
  Texture normals;  // x, y, z along tangent, bitangent, normal; 0 to 255 is -1 to 1
  Texture colours;  // sRGB; without texels when there are none
};

}  // namespace dynasurf::mesh
