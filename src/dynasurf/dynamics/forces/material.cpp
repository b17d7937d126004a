#include "dynasurf/dynamics/forces/detail/material.hpp"

#include <cmath>

namespace dynasurf::dynamics::conditions {

std::vector<MaterialTriangle> material_triangles(const TriMesh& rest, double area_unit_mm2) {
  std::vector<MaterialTriangle> list;
  double total = 0;
  for (const auto& t : rest.triangles) {
    const Vec3 first = rest.vertices[t[1]] - rest.vertices[t[0]], second = rest.vertices[t[2]] - rest.vertices[t[0]];
    const double doubled = first.cross(second).norm(), longest = std::max(first.norm(), second.norm());
    total += doubled / 2;
    if (!(doubled > 1e-12 * longest * longest)) continue;  // no material to speak of
    // Laid flat with the first vertex at 0 and the second on the u axis, dv1 = 0.
    const double du1 = first.norm(), du2 = first.dot(second) / du1, dv2 = doubled / du1;
    const double d = du1 * dv2;
    list.push_back({t, {-dv2 / d, dv2 / d, 0}, {(du2 - du1) / d, -du2 / d, du1 / d}, doubled / 2});
  }
  const double unit = area_unit_mm2 > 0 ? area_unit_mm2 : total / rest.triangles.size();
  for (MaterialTriangle& m : list) m.area /= unit;
  return list;
}

}  // namespace dynasurf::dynamics::conditions
