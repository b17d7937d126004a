#pragma once
#include <optional>

#include "dynasurf/dynamics/particles.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"

namespace dynasurf {

/// What an implicit step had to do.
struct ImplicitStep {
  int iterations = 0;          // of conjugate gradients
  double residual = 0;         // reached, of the right side
  bool converged = true;       // to the tolerance
  bool made_definite = false;  // `exact` was asked for, but the system was not definite
};

/// Advances a particle system by any of the solvers, and keeps their memory between the steps.
class ParticleSolver {
 public:
  explicit ParticleSolver(const SolverOptions& solver) : solver_(solver) {}

  /// One step of `h` seconds. Pinned particles neither move nor have a speed afterwards. For BackwardEuler,
  ///     (M - h Kv - h^2 Kx) dv = h (f + h Kx v),   v += dv,   x += h v
  /// with the Jacobians Kx, Kv of those forces that have them (thesis 4.44, A.5), by conjugate gradients with a block
  /// diagonal preconditioner; other solvers report an empty ImplicitStep. The same bytes for any number of threads.
  ImplicitStep step(ParticleSystem& system, double h);

 private:
  void step_explicit(ParticleSystem& system, double h);
  ImplicitStep step_implicit(ParticleSystem& system, double h, const BackwardEuler& options);

  SolverOptions solver_;
  std::vector<double> y_, scratch_;
  std::optional<ForceJacobian> jacobian_;
};

/// y' of a system with y = all positions, then all velocities (6 numbers per particle). `system` must outlive it; its
/// positions and velocities are not read.
Derivative motion_of(const ParticleSystem& system);

/// What bounds the step of the explicit solvers, from the Jacobians at the present state: largest eigenvalues of
/// -M^-1 dF/dx (1/s2) and -M^-1 dF/dv (1/s), by power iteration.
struct Fastest {
  double stiffness = 0, damping = 0;
};
/// Where a search for them ended: a good place for the next one to begin while a system moves on.
struct ModeSearch {
  std::vector<Vec3> stiffest, most_damped;
};
/// With `former`, begins there, needs a fifth of the work, and leaves its own end there.
Fastest fastest_modes(const ParticleSystem& system, ModeSearch* former = nullptr);

}  // namespace dynasurf
