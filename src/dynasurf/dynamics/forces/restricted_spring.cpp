#include <memory>

#include "dynasurf/dynamics/detail/field_force.hpp"
#include "dynasurf/dynamics/forces/detail/spring.hpp"
#include "dynasurf/dynamics/forces/forces.hpp"

namespace dynasurf::dynamics {
namespace {

struct Restriction {
  field::FieldView field;
  field::Sampling sampling;
  double threshold;  // 1/mm

  /// What is left of space when the direction of the field is taken away.
  Mat3 operator()(const ParticleState& state, std::uint32_t p) const {
    const Vec3 g = field.at_point(state.positions[p], sampling, state.velocities[p]);
    const double length = g.norm();
    if (!(length > threshold)) return Mat3::Identity();
    return Mat3::Identity() - (g / length) * (g / length).transpose();
  }
};

}  // namespace

Force restricted_spring_force(std::vector<Spring> springs, field::FieldView field, const RestrictedSpringForce& o) {
  const auto list = std::make_shared<const std::vector<Spring>>(std::move(springs));
  const Restriction restrict {field, o.sampling, o.threshold * field.largest()};
  Force force{"restricted_spring"};
  force.accumulate = [list, restrict, o](const ParticleState& state, std::span<Vec3> forces) {
    std::vector<Vec3> sum(forces.size(), Vec3::Zero());
    for (const Spring& s : *list) {
      if (springs::is_held(s, state)) continue;
      const Vec3 f = springs::force_on_a(s, o.stiffness, o.damping, state);
      sum[s.a] += f;
      sum[s.b] -= f;
    }
    for (std::uint32_t p = 0; p < sum.size(); ++p)
      if (!state.is_pinned(p)) forces[p] += restrict(state, p) * sum[p];
  };
  // Projected from both sides: symmetric as conjugate gradients want it, at the price of being inexact.
  force.jacobian = [list, restrict, o](const ParticleState& state, ForceJacobian& jacobian) {
    for (const Spring& s : *list) {
      if (springs::is_held(s, state)) continue;
      const springs::Slopes j = springs::slopes_on_a(s, o.stiffness, o.damping, state, jacobian.definite());
      const Mat3 a = restrict(state, s.a), b = restrict(state, s.b);
      jacobian.add(s.a, s.a, a * j.dfdx * a, a * j.dfdv * a);
      jacobian.add(s.b, s.b, b * j.dfdx * b, b * j.dfdv * b);
      jacobian.add(s.a, s.b, -a * j.dfdx * b, -a * j.dfdv * b);
      jacobian.add(s.b, s.a, -b * j.dfdx * a, -b * j.dfdv * a);
    }
  };
  return force;
}

}  // namespace dynasurf::dynamics
