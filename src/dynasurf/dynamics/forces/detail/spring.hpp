#pragma once
#include "dynasurf/dynamics/forces/forces.hpp"

// What springs and restricted springs share.
namespace dynasurf::dynamics::springs {

/// Nobody asks for the force of a spring between two pinned particles.
inline bool is_held(const Spring& s, const ParticleState& state) {
  return state.is_pinned(s.a) && state.is_pinned(s.b);
}

/// f_a = -[ks (|l| - r) + kd (l'.l)/|l|] l/|l| with l = x_a - x_b (thesis 3.56); none for a spring of no length.
inline Vec3 force_on_a(const Spring& s, double stiffness, double damping, const ParticleState& state) {
  const Vec3 l = state.positions[s.a] - state.positions[s.b];
  const double length = l.norm();
  if (!(length > 0)) return Vec3::Zero();
  const Vec3 unit = l / length;
  const double rate = unit.dot(state.velocities[s.a] - state.velocities[s.b]);
  return -(stiffness * (length - s.rest_mm) + damping * rate) * unit;
}

/// Slopes of that force by x_a and v_a; by x_b and v_b they are the opposite.
struct Slopes {
  Mat3 dfdx = Mat3::Zero(), dfdv = Mat3::Zero();
};

/// Without the non-symmetric part of the damping, as for conditions. When they must be definite, the sideways part goes
/// where the spring pushes.
inline Slopes slopes_on_a(const Spring& s, double stiffness, double damping, const ParticleState& state,
                          bool definite) {
  const Vec3 l = state.positions[s.a] - state.positions[s.b];
  const double length = l.norm();
  if (!(length > 0)) return {};
  const Vec3 unit = l / length;
  const Mat3 along = unit * unit.transpose(), across = Mat3::Identity() - along;
  const double rate = damping > 0 ? unit.dot(state.velocities[s.a] - state.velocities[s.b]) : 0;
  const double pull = stiffness * (length - s.rest_mm) + damping * rate;
  Slopes slopes{-stiffness * along, -damping * along};
  if (!definite || pull > 0) slopes.dfdx -= pull / length * across;
  return slopes;
}

}  // namespace dynasurf::dynamics::springs
