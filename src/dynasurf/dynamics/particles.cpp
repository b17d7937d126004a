#include "dynasurf/dynamics/particles.hpp"

#include <algorithm>

namespace dynasurf::dynamics {

void ForceJacobian::add(std::uint32_t row, std::uint32_t column, const Mat3& dfdx, const Mat3& dfdv) {
  Row& r = rows_[row];
  // A vertex has a dozen partners: looking through them beats any clever index.
  const auto found = std::find(r.columns.begin(), r.columns.end(), column);
  const std::size_t at = found - r.columns.begin();
  if (found == r.columns.end()) {
    r.columns.push_back(column);
    r.dfdx.push_back(dfdx);
    r.dfdv.push_back(dfdv);
    return;
  }
  r.dfdx[at] += dfdx;
  r.dfdv[at] += dfdv;
}

void ForceJacobian::clear(bool definite) {
  definite_ = definite;
  for (Row& row : rows_) {
    std::fill(row.dfdx.begin(), row.dfdx.end(), Mat3::Zero());
    std::fill(row.dfdv.begin(), row.dfdv.end(), Mat3::Zero());
  }
}

ParticleSystem particles_at(std::span<const Vec3> positions, double mass_kg) {
  ParticleSystem system;
  system.positions.assign(positions.begin(), positions.end());
  system.velocities.assign(positions.size(), Vec3::Zero());
  system.masses.assign(positions.size(), mass_kg / positions.size());
  return system;
}

void total_force(std::span<const Force> forces, const ParticleState& state, std::span<Vec3> sum) {
  std::fill(sum.begin(), sum.end(), Vec3::Zero());
  for (const Force& force : forces) force.accumulate(state, sum);
}

double potential_energy(const ParticleSystem& system) {
  double energy = 0;
  for (const Force& force : system.forces)
    if (force.energy) energy += force.energy(system.state());
  return energy;
}

double kinetic_energy(const ParticleSystem& system) {
  double energy = 0;
  for (std::size_t p = 0; p < system.size(); ++p) energy += system.masses[p] / 2 * system.velocities[p].squaredNorm();
  return energy;
}

}  // namespace dynasurf::dynamics
