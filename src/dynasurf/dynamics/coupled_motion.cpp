#include "dynasurf/dynamics/detail/coupled_motion.hpp"

#include <algorithm>

#include "dynasurf/dynamics/detail/step_plan.hpp"

namespace dynasurf::dynamics {

CoupledMotion::CoupledMotion(const TriMesh& start, double mass_kg, std::vector<Force> forces,
                             const SolverOptions& solver, double least_drag)
    : system_(particles_at(start.vertices, mass_kg)),
      options_(solver),
      solver_(solver, speed_unit(least_drag, system_.masses.front())) {
  system_.forces = std::move(forces);
}

int CoupledMotion::step(std::span<const Vec3> vertices, std::span<const std::uint32_t> moving, std::span<double> state,
                        double h, int most) {
  std::copy(vertices.begin(), vertices.end(), system_.positions.begin());
  system_.pinned.assign(system_.size(), 1);
  std::fill(system_.velocities.begin(), system_.velocities.end(), Vec3::Zero());
  for (std::size_t s = 0; s < moving.size(); ++s) {
    system_.pinned[moving[s]] = 0;
    system_.velocities[moving[s]] = Eigen::Map<const Vec3>(&state[6 * s + 3]);
  }
  const SolverWork work = solver_.step(system_, h, most);
  if (!work.converged) ++unsolved_steps_;
  for (std::size_t s = 0; s < moving.size(); ++s) {
    Eigen::Map<Vec3>{&state[6 * s]} = system_.positions[moving[s]];
    Eigen::Map<Vec3>{&state[6 * s + 3]} = system_.velocities[moving[s]];
  }
  return work.steps;
}

CoupledMotion::Limit CoupledMotion::limit(double least_drag) {
  const Fastest modes = fastest_modes(system_, &search_);
  const double drag = least_drag / system_.masses.front();
  // The stiffest motion may be damped by all dampers or by the drag alone, and the most damped one need not be stiff.
  const double step = std::min({oscillator_limit_s(options_, modes.stiffness, modes.damping),
                                oscillator_limit_s(options_, modes.stiffness, std::min(drag, modes.damping)),
                                oscillator_limit_s(options_, 0, modes.damping)});
  return {step, modes};
}

}  // namespace dynasurf::dynamics
