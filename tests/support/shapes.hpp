#pragma once
#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/mesh/shapes.hpp"

// Shapes made by code, so that a test shows its whole story.
namespace dynasurf::test_shapes {

/// Of all vertices.
inline bool same_bytes(const TriMesh& a, const TriMesh& b) {
  return a.vertices.size() == b.vertices.size() &&
         std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(Vec3)) == 0;
}

inline TriMesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

/// The unit cube [0,1]^3, two triangles to a side.
inline TriMesh cube() {
  TriMesh m;
  for (int v = 0; v < 8; ++v) m.vertices.emplace_back(v & 1, (v >> 1) & 1, (v >> 2) & 1);
  m.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return m;
}

/// Ring of radius `R` about z, tube radius `r`: genus 1, with saddles.
inline TriMesh torus(double R, double r, std::uint32_t around, std::uint32_t across) {
  TriMesh m;
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      m.vertices.emplace_back((R + r * std::cos(v)) * std::cos(u), (R + r * std::cos(v)) * std::sin(u),
                              r * std::sin(v));
    }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return (i % around) * across + j % across; };
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return m;
}

/// A flat square sheet of n x n cells of side 1 in the plane z = 0, open at its rim.
inline TriMesh sheet(std::uint32_t n) {
  TriMesh m;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) m.vertices.emplace_back(i, j, 0);
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return j * (n + 1) + i; };
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return m;
}

inline TriMesh mapped(TriMesh m, const std::function<Vec3(const Vec3&)>& map) {
  for (Vec3& p : m.vertices) p = map(p);
  return m;
}
inline TriMesh moved(const TriMesh& m, const Vec3& by) {
  return mapped(m, [&](const Vec3& p) { return Vec3(p + by); });
}
inline TriMesh ellipsoid(int level, const Vec3& half_axes) {
  return mapped(mesh::icosphere(level), [&](const Vec3& p) { return Vec3(p.cwiseProduct(half_axes)); });
}

struct NamedMesh {
  std::string name;
  TriMesh mesh;
};

/// Closed meshes of several kinds, sizes and places: laws must hold on all of them.
inline std::vector<NamedMesh> closed_meshes() {
  const auto bumpy = [](const Vec3& p) {
    return Vec3(p * (20 + 3 * std::sin(5 * p[0]) * std::cos(4 * p[1]) + 2 * p[2] * p[2]));
  };
  return {{"tetrahedron", tetrahedron()},
          {"cube", cube()},
          {"icosphere 0", mesh::icosphere(0)},
          {"icosphere 3", mesh::icosphere(3)},
          {"ellipsoid", moved(ellipsoid(3, {53.5, 56.6, 70}), {90, 91, 60})},
          {"flat ellipsoid", ellipsoid(2, {40, 30, 0.5})},
          {"bumpy sphere", mapped(mesh::icosphere(4), bumpy)},
          {"torus", moved(torus(30, 10, 40, 20), {5, -70, 12})}};
}

using Inside = std::function<bool(const Vec3&)>;

/// Voxels whose centre (grid frame) is inside.
inline Image filled(const Grid& grid, const Inside& inside) {
  Image image(grid);
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) image(i, j, k) = inside(centre_of(grid, {i, j, k})) ? 1.0F : 0.0F;
  return image;
}

/// The voxels of a solid that share a face with a voxel outside it.
inline Image border_of(const Image& solid) {
  Image border(solid.grid);
  const Index3 n = solid.grid.dims;
  const auto value = [&](int i, int j, int k) { return solid.grid.contains(i, j, k) ? solid(i, j, k) : 0.0F; };
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        const bool surrounded = value(i - 1, j, k) != 0 && value(i + 1, j, k) != 0 && value(i, j - 1, k) != 0 &&
                                value(i, j + 1, k) != 0 && value(i, j, k - 1) != 0 && value(i, j, k + 1) != 0;
        border(i, j, k) = solid(i, j, k) != 0 && !surrounded ? 1.0F : 0.0F;
      }
  return border;
}

inline std::size_t count_non_zero(const Image& image) {
  return static_cast<std::size_t>(
      std::count_if(image.values.begin(), image.values.end(), [](float v) { return v != 0; }));
}

}  // namespace dynasurf::test_shapes
