#pragma once
#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "dynasurf/dynamics/particles.hpp"

// The framework of conditions (INT-COND, thesis eqs 3.50-3.55; Baraff and Witkin 1998): a scalar C of a few particles
// that the force wants to be zero.
//
//     E = k/2 C^2     f_i = -k (dC/dx_i) C     d_i = -k_d (dC/dx_i) C'     C' = sum_j (dC/dx_j) . v_j
//
// The sign of the damping is Baraff and Witkin's; the printed one would push.
namespace dynasurf::dynamics::conditions {

/// Which derivatives are asked for: second ones are dear, and a definite system can use none but positive ones.
enum class Want { gradient, positive_hessian, hessian };

/// A condition at one state, of N particles.
template <std::size_t N>
struct Condition {
  std::array<std::uint32_t, N> particles{};
  double value = 0;
  std::array<Vec3, N> gradient{};
  /// Second derivatives; filled only when asked for.
  std::array<std::array<Mat3, N>, N> hessian{};
  bool hessian_is_positive = false;  // positive semidefinite, for certain
};

struct Stiffness {
  double stiffness = 0, damping = 0;
};

template <std::size_t N>
double rate(const Condition<N>& c, const ParticleState& state) {
  double sum = 0;
  for (std::size_t i = 0; i < N; ++i) sum += c.gradient[i].dot(state.velocities[c.particles[i]]);
  return sum;
}

template <std::size_t N>
void add_force(const Condition<N>& c, const Stiffness& s, const ParticleState& state, std::span<Vec3> forces) {
  const double push = s.stiffness * c.value + (s.damping > 0 ? s.damping * rate(c, state) : 0);
  for (std::size_t i = 0; i < N; ++i) forces[c.particles[i]] -= push * c.gradient[i];
}

/// The Jacobian without the non-symmetric part of the damping, which Baraff and Witkin drop, too. When it must be
/// definite, second derivatives stay only where they cannot harm: positive ones under tension.
template <std::size_t N>
void add_jacobian(const Condition<N>& c, const Stiffness& s, const ParticleState& state, ForceJacobian& jacobian) {
  const double bend = s.stiffness * c.value + (s.damping > 0 ? s.damping * rate(c, state) : 0);
  const bool keep = !jacobian.definite() || (c.hessian_is_positive && bend > 0);
  for (std::size_t i = 0; i < N; ++i) {
    if (state.is_pinned(c.particles[i])) continue;
    for (std::size_t j = 0; j < N; ++j) {
      if (state.is_pinned(c.particles[j])) continue;
      const Mat3 outer = c.gradient[i] * c.gradient[j].transpose();
      Mat3 dfdx = -s.stiffness * outer;
      if (keep) dfdx -= bend * c.hessian[i][j];
      jacobian.add(c.particles[i], c.particles[j], dfdx, -s.damping * outer);
    }
  }
}

/// Whether nobody asks for what acts on the particles of an element.
template <class Element>
bool is_held(const Element& e, const ParticleState& state) {
  return std::all_of(e.particles.begin(), e.particles.end(), [&](std::uint32_t p) { return state.is_pinned(p); });
}

/// Puts a force together from a list of elements and `evaluate(element, state, want, use)`, which calls
/// `use(condition)` for every condition of the element, and for none where the element is degenerate. Elements whose
/// particles are all pinned are passed over: near the end of a run those are most.
template <class Element, class Evaluate>
Force make_force(std::string name, std::vector<Element> elements, Stiffness s, Evaluate evaluate) {
  const auto shared = std::make_shared<const std::vector<Element>>(std::move(elements));
  Force force{std::move(name)};
  force.accumulate = [shared, s, evaluate](const ParticleState& state, std::span<Vec3> forces) {
    for (const Element& e : *shared)
      if (!is_held(e, state))
        evaluate(e, state, Want::gradient, [&](const auto& condition) { add_force(condition, s, state, forces); });
  };
  force.jacobian = [shared, s, evaluate](const ParticleState& state, ForceJacobian& jacobian) {
    const Want want = jacobian.definite() ? Want::positive_hessian : Want::hessian;
    for (const Element& e : *shared)
      if (!is_held(e, state))
        evaluate(e, state, want, [&](const auto& condition) { add_jacobian(condition, s, state, jacobian); });
  };
  force.energy = [shared, s, evaluate](const ParticleState& state) {
    double sum = 0;
    for (const Element& e : *shared)
      evaluate(e, state, Want::gradient,
               [&](const auto& condition) { sum += s.stiffness / 2 * condition.value * condition.value; });
    return sum;
  };
  return force;
}

}  // namespace dynasurf::dynamics::conditions
