#include "dynasurf/dynamics/forces/detail/condition.hpp"
#include "dynasurf/dynamics/forces/detail/material.hpp"
#include "dynasurf/dynamics/forces/forces.hpp"

namespace dynasurf::dynamics {
namespace {

using namespace conditions;

/// C = a (|W| - b) for one of the two directions of the material.
template <class Use>
void stretch_along(const MaterialTriangle& t, const std::array<double, 3>& weights, double b,
                   const ParticleState& state, Want want, Use use) {
  const Vec3 w = tangent(t, weights, state.positions);
  const double length = w.norm();
  if (!(length > 1e-12)) return;  // its direction is not defined
  const Vec3 unit = w / length;
  Condition<3> c{t.particles, t.area * (length - b)};
  for (std::size_t m = 0; m < 3; ++m) c.gradient[m] = t.area * weights[m] * unit;
  c.hessian_is_positive = true;
  if (want != Want::gradient) {
    const Mat3 across = t.area / length * (Mat3::Identity() - unit * unit.transpose());
    for (std::size_t m = 0; m < 3; ++m)
      for (std::size_t n = 0; n < 3; ++n) c.hessian[m][n] = weights[m] * weights[n] * across;
  }
  use(c);
}

}  // namespace

Force stretch_force(const TriMesh& rest, const StretchForce& o) {
  return make_force("stretch", material_triangles(rest, o.area_unit_mm2), {o.stiffness, o.damping},
                    [b = o.rest_scale](const MaterialTriangle& t, const ParticleState& state, Want want, auto use) {
                      stretch_along(t, t.p, b, state, want, use);
                      stretch_along(t, t.q, b, state, want, use);
                    });
}

}  // namespace dynasurf::dynamics
