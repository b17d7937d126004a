#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "dynasurf/core/volume.hpp"

/// Edge maps made by formula, for the tests of fields.
namespace dynasurf::test {

inline Grid box(int nx, int ny, int nz, const Vec3& spacing = {1, 1, 1}) {
  Grid g;
  g.dims = {nx, ny, nz};
  g.spacing = spacing;
  return g;
}

/// Value of `formula(point in mm from the centre of the grid)` at every voxel.
template <class F>
Image drawn(const Grid& g, F formula) {
  Image f(g);
  const Vec3 centre = Vec3(g.dims[0] - 1, g.dims[1] - 1, g.dims[2] - 1).cwiseProduct(g.spacing) / 2;
  for (int k = 0; k < g.dims[2]; ++k)
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i)
        f(i, j, k) = static_cast<float>(formula(Vec3(centre_of(g, {i, j, k}) - centre)));
  return f;
}

/// 1 on the voxels of a solid that touch the outside by a face: a closed border one voxel thick.
template <class F>
Image border_of(const Grid& g, F is_inside) {
  const Image solid = drawn(g, [&](const Vec3& p) { return is_inside(p) ? 1.0 : 0.0; });
  Image border(g);
  for (int k = 0; k < g.dims[2]; ++k)
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i) {
        const float outside =
            std::min({solid.clamped(i - 1, j, k), solid.clamped(i + 1, j, k), solid.clamped(i, j - 1, k),
                      solid.clamped(i, j + 1, k), solid.clamped(i, j, k - 1), solid.clamped(i, j, k + 1)});
        border(i, j, k) = solid(i, j, k) > 0 && outside == 0 ? 1.0f : 0.0f;
      }
  return border;
}

/// A cup: a cylinder of height `height` on a half sphere, both of radius `radius`, opening towards high z (mm).
inline bool is_in_cup(const Vec3& p, double radius, double height) {
  const double z = p[2] + (height - radius) / 2, r2 = p[0] * p[0] + p[1] * p[1];
  return z >= 0 ? z <= height && r2 <= radius * radius : r2 + z * z <= radius * radius;
}

/// Noise in [0, 1) that is the same on every machine.
inline Image noise(const Grid& g, std::uint32_t seed) {
  Image f(g);
  for (float& v : f.values) {
    seed = seed * 1664525u + 1013904223u;
    v = static_cast<float>(seed >> 8) / static_cast<float>(1u << 24);
  }
  return f;
}

/// Gaussian blur with replicated borders.
inline Image blurred(const Image& f, double sigma_mm) {
  Image from = f, to = f;
  for (int axis = 0; axis < 3; ++axis) {
    const int reach = static_cast<int>(std::ceil(4 * sigma_mm / f.grid.spacing[axis]));
    std::vector<double> weight;
    double sum = 0;
    for (int s = -reach; s <= reach; ++s) {
      const double x = s * f.grid.spacing[axis] / sigma_mm;
      weight.push_back(std::exp(-x * x / 2));
      sum += weight.back();
    }
    for (int k = 0; k < f.grid.dims[2]; ++k)
      for (int j = 0; j < f.grid.dims[1]; ++j)
        for (int i = 0; i < f.grid.dims[0]; ++i) {
          double v = 0;
          for (int s = -reach; s <= reach; ++s) {
            Index3 at{i, j, k};
            at[axis] += s;
            v += weight[static_cast<std::size_t>(s + reach)] * from.clamped(at[0], at[1], at[2]);
          }
          to(i, j, k) = static_cast<float>(v / sum);
        }
    std::swap(from, to);
  }
  return from;
}

/// The wall of the thesis's cardiac phantom (appendix D) as a camera sees it: the share of each voxel that lies between
/// two cups, blurred and scaled to a maximum of 1. `scale` 1 is the large phantom, 0.9585 the small one.
inline Image cardiac_phantom(const Grid& g, double scale, double sigma_mm) {
  constexpr int fine = 3;
  const auto is_wall = [&](const Vec3& p) {
    const double height = 55 * scale, outer = 35 * scale, inner = 20 * scale;
    const Vec3 lowered = p + Vec3(0, 0, (inner - outer) / 2);  // both cups share the plane where the half sphere ends
    return is_in_cup(p, outer, height) && !is_in_cup(lowered, inner, height);
  };
  Image wall = drawn(g, [&](const Vec3& p) {
    int hits = 0;
    for (int c = 0; c < fine * fine * fine; ++c) {
      const Vec3 offset((c % fine - 1) / double(fine), (c / fine % fine - 1) / double(fine),
                        (c / fine / fine - 1) / double(fine));
      hits += is_wall(p + offset.cwiseProduct(g.spacing));
    }
    return hits / double(fine * fine * fine);
  });
  wall = blurred(wall, sigma_mm);
  const float top = *std::max_element(wall.values.begin(), wall.values.end());
  for (float& v : wall.values) v /= top;
  return wall;
}

}  // namespace dynasurf::test
