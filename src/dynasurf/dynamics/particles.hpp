#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "dynasurf/core/grid.hpp"

namespace dynasurf::dynamics {

/// Where particles are and how they move: mm and mm/s, one entry per particle. Forces on pinned particles are ignored.
struct ParticleState {
  std::span<const Vec3> positions, velocities;
  std::span<const std::uint8_t> pinned = {};  // non-zero: held; may be empty

  bool is_pinned(std::size_t p) const { return !pinned.empty() && pinned[p] != 0; }
};

/// The derivatives of a force in 3x3 blocks: how the force on particle `row` changes with the place (dfdx) and the
/// speed (dfdv) of particle `column`. Pairs that were never added are zero.
class ForceJacobian {
 public:
  struct Row {
    std::vector<std::uint32_t> columns;
    std::vector<Mat3> dfdx, dfdv;
  };

  /// With `definite`, a force leaves out what would make -dfdx or -dfdv indefinite: conjugate gradients need that.
  explicit ForceJacobian(std::size_t particles, bool definite = true) : rows_(particles), definite_(definite) {}

  bool definite() const { return definite_; }
  void add(std::uint32_t row, std::uint32_t column, const Mat3& dfdx, const Mat3& dfdv);
  const std::vector<Row>& rows() const { return rows_; }
  /// Zeroes all blocks and keeps their places: the next step of the same mesh allocates nothing.
  void clear(bool definite);

 private:
  std::vector<Row> rows_;
  bool definite_;
};

/// A force as a value. A force of one's own is a name and a function:
///
///     Force wind{"wind", [](const ParticleState& s, std::span<Vec3> forces) {
///                  for (Vec3& f : forces) f += Vec3(0.1, 0, 0);
///                }};
///
/// The functions may be called from any thread, one call at a time, and must give the same answer for the same state.
struct Force {
  std::string name;
  /// Adds the force on every particle, in kg mm/s2.
  std::function<void(const ParticleState&, std::span<Vec3> forces)> accumulate = {};
  /// Adds the derivatives. May be empty: implicit solvers treat the force as constant within a step then.
  std::function<void(const ParticleState&, ForceJacobian&)> jacobian = {};
  /// Potential energy, kg mm2/s2. May be empty; no solver asks for it.
  std::function<double(const ParticleState&)> energy = {};
};

/// Newtonian particles and what acts on them (SYS-PARTICLE, thesis 3.1): x' = v, v' = F / m.
struct ParticleSystem {
  std::vector<Vec3> positions;       // mm
  std::vector<Vec3> velocities;      // mm/s
  std::vector<double> masses;        // kg, positive
  std::vector<std::uint8_t> pinned;  // non-zero: never moves; may be empty
  std::vector<Force> forces;

  std::size_t size() const { return positions.size(); }
  ParticleState state() const { return {positions, velocities, pinned}; }
  bool is_pinned(std::size_t p) const { return !pinned.empty() && pinned[p] != 0; }
};

/// Particles at rest at the given places, sharing `mass_kg` equally (thesis: 1 kg for a whole mesh).
ParticleSystem particles_at(std::span<const Vec3> positions, double mass_kg = 1);

/// Sum of all forces on each particle of a state.
void total_force(std::span<const Force> forces, const ParticleState& state, std::span<Vec3> sum);

/// Sum of the energies of those forces that have one.
double potential_energy(const ParticleSystem& system);
double kinetic_energy(const ParticleSystem& system);

}  // namespace dynasurf::dynamics
