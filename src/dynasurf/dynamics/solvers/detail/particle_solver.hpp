#pragma once
#include <limits>
#include <optional>

#include "dynasurf/dynamics/particles.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"

namespace dynasurf::dynamics {

/// What a step had to do.
struct SolverWork {
  int steps = 1;               // into which the step was cut, those tried in vain included
  int iterations = 0;          // of conjugate gradients; this and what follows: of implicit solvers
  double residual = 0;         // reached, of the right side
  bool converged = true;       // to the tolerance
  bool made_definite = false;  // `exact` was asked for, but the system was not definite
};

/// Advances a particle system by any of the solvers, and keeps their memory between the steps.
class ParticleSolver {
 public:
  /// AutomaticSolver is backward Euler here: it is stable for any step. Solvers that control their error hold their
  /// tolerance in mm for places, and in mm times `speed_unit` (1/s) for speeds.
  explicit ParticleSolver(const SolverOptions& solver, double speed_unit = 1)
      : solver_(std::holds_alternative<AutomaticSolver>(solver) ? BackwardEuler{} : solver), speed_unit_(speed_unit) {}

  /// One step of `h` seconds. Pinned particles neither move nor have a speed afterwards. For BackwardEuler,
  ///     (M - h Kv - h^2 Kx) dv = h (f + h Kx v),   v += dv,   x += h v
  /// with the Jacobians Kx, Kv of those forces that have them (thesis 4.44, A.5), by conjugate gradients with a block
  /// diagonal preconditioner; solvers that control their error stop short of `h` after `most` steps. The
  /// same bytes for any number of threads.
  SolverWork step(ParticleSystem& system, double h, int most = std::numeric_limits<int>::max());

 private:
  SolverWork step_explicit(ParticleSystem& system, double h, int most);
  SolverWork step_implicit(ParticleSystem& system, double h, const BackwardEuler& options);

  SolverOptions solver_;
  double speed_unit_;
  std::vector<double> y_, scratch_, units_;
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

}  // namespace dynasurf::dynamics
