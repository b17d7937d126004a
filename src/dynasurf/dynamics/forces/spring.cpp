#include "dynasurf/dynamics/forces/detail/spring.hpp"

#include <algorithm>
#include <memory>

#include "dynasurf/dynamics/forces/forces.hpp"

namespace dynasurf::dynamics {

std::vector<Spring> springs_of(const TriMesh& mesh, double rest_scale) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(std::minmax(t[k], t[(k + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<Spring> springs;
  springs.reserve(edges.size());
  for (const auto& [a, b] : edges) springs.push_back({a, b, rest_scale * (mesh.vertices[a] - mesh.vertices[b]).norm()});
  return springs;
}

Force spring_force(std::vector<Spring> springs, const SpringForce& o) {
  const auto list = std::make_shared<const std::vector<Spring>>(std::move(springs));
  Force force{"spring"};
  force.accumulate = [list, o](const ParticleState& state, std::span<Vec3> forces) {
    for (const Spring& s : *list) {
      if (springs::is_held(s, state)) continue;
      const Vec3 f = springs::force_on_a(s, o.stiffness, o.damping, state);
      forces[s.a] += f;
      forces[s.b] -= f;
    }
  };
  force.jacobian = [list, o](const ParticleState& state, ForceJacobian& jacobian) {
    for (const Spring& s : *list) {
      if (springs::is_held(s, state)) continue;
      const springs::Slopes j = springs::slopes_on_a(s, o.stiffness, o.damping, state, jacobian.definite());
      jacobian.add(s.a, s.a, j.dfdx, j.dfdv);
      jacobian.add(s.b, s.b, j.dfdx, j.dfdv);
      jacobian.add(s.a, s.b, -j.dfdx, -j.dfdv);
      jacobian.add(s.b, s.a, -j.dfdx, -j.dfdv);
    }
  };
  force.energy = [list, o](const ParticleState& state) {
    double sum = 0;
    for (const Spring& s : *list) {
      const double longer = (state.positions[s.a] - state.positions[s.b]).norm() - s.rest_mm;
      sum += o.stiffness / 2 * longer * longer;
    }
    return sum;
  };
  return force;
}

}  // namespace dynasurf::dynamics
