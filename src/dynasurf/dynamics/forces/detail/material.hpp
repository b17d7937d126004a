#pragma once
#include <array>
#include <span>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::dynamics::conditions {

/// A triangle with its material coordinates (thesis 3.4-3.7): dx/du = sum p_m x_m, dx/dv = sum q_m x_m.
struct MaterialTriangle {
  std::array<std::uint32_t, 3> particles{};
  std::array<double, 3> p{}, q{};
  double area = 0;  // in the unit that was asked for
};

/// Every triangle of `rest` laid flat, its first vertex at 0 and the second on the u axis; areas in `area_unit_mm2`, or
/// in the mean triangle's where that is 0. Triangles without area are left out.
std::vector<MaterialTriangle> material_triangles(const TriMesh& rest, double area_unit_mm2);

/// dx/du or dx/dv of a triangle.
inline Vec3 tangent(const MaterialTriangle& t, const std::array<double, 3>& weights, std::span<const Vec3> positions) {
  return weights[0] * positions[t.particles[0]] + weights[1] * positions[t.particles[1]] +
         weights[2] * positions[t.particles[2]];
}

}  // namespace dynasurf::dynamics::conditions
