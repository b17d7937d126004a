#include "dynasurf/dynamics/forces/detail/condition.hpp"
#include "dynasurf/dynamics/forces/detail/material.hpp"
#include "dynasurf/dynamics/forces/forces.hpp"

namespace dynasurf::dynamics {

using namespace conditions;

// C = a Wu . Wv; its second derivatives are multiples of the identity and of either sign.
Force shear_force(const TriMesh& rest, const ShearForce& o) {
  return make_force("shear", material_triangles(rest, o.area_unit_mm2), {o.stiffness, o.damping},
                    [](const MaterialTriangle& t, const ParticleState& state, Want want, auto use) {
                      const Vec3 wu = tangent(t, t.p, state.positions), wv = tangent(t, t.q, state.positions);
                      Condition<3> c{t.particles, t.area * wu.dot(wv)};
                      for (std::size_t m = 0; m < 3; ++m) c.gradient[m] = t.area * (t.p[m] * wv + t.q[m] * wu);
                      if (want == Want::hessian)
                        for (std::size_t m = 0; m < 3; ++m)
                          for (std::size_t n = 0; n < 3; ++n)
                            c.hessian[m][n] = t.area * (t.p[m] * t.q[n] + t.q[m] * t.p[n]) * Mat3::Identity();
                      use(c);
                    });
}

}  // namespace dynasurf::dynamics
