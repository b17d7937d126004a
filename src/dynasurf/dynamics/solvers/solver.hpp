#pragma once
#include <limits>
#include <optional>
#include <span>

#include "dynasurf/dynamics/particles.hpp"
#include "dynasurf/dynamics/solvers/detail/adaptive_step.hpp"
#include "dynasurf/dynamics/solvers/detail/solver_options.hpp"

namespace dynasurf::dynamics {

/// Advances y by one step of `h`. `scratch` holds at least kSolverScratch * y.size() numbers, whose contents are lost.
/// Global errors of the first three are of order h, h^2 and h^4; the two after them cut the step until their tolerance
/// holds (see advance_once). The last throws OptionError for BackwardEuler, which needs the Jacobians of a particle
/// system (particle_solver.hpp), and for AutomaticSolver, which needs a model. Its `units` are what the tolerance
/// counts the errors of the unknowns in, one per unknown; without them, 1. It returns how many steps `h` was cut into,
/// those tried in vain included, and stops short of `h` after `most` of them.
void advance(const Euler&, std::span<double> y, double h, const Derivative& f, std::span<double> scratch);
void advance(const Midpoint&, std::span<double> y, double h, const Derivative& f, std::span<double> scratch);
void advance(const Rk4&, std::span<double> y, double h, const Derivative& f, std::span<double> scratch);
void advance(const StepDoubling&, std::span<double> y, double h, const Derivative& f, std::span<double> scratch);
void advance(const Rkf45&, std::span<double> y, double h, const Derivative& f, std::span<double> scratch);
int advance(const SolverOptions&, std::span<double> y, double h, const Derivative& f, std::span<double> scratch,
            std::span<const double> units = {}, int most = std::numeric_limits<int>::max());

/// End of the interval of z = h * rate in which y' = -rate y does not grow: 2 for Euler and midpoint, 2.785 for RK4,
/// infinity for solvers that control their error or are implicit.
double stability_interval(const SolverOptions& solver);

/// The largest h with which x'' = -damping x' - stiffness x (1/s and 1/s2, not negative) does not grow: what an
/// oscillator allows. Zero when every step grows, which Euler's does without damping.
double oscillator_limit_s(const SolverOptions& solver, double stiffness, double damping);

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

/// Solves a tridiagonal system by elimination without pivots (Thomas): row i reads lower[i] x[i-1] + diagonal[i] x[i] +
/// upper[i] x[i+1] = x[i] on entry; lower[0] and upper[n-1] are ignored. `x` holds the right side and then the
/// solution. Exact to rounding for diagonally dominant or symmetric definite matrices. Linear in n.
void solve_tridiagonal(std::span<const double> lower, std::span<const double> diagonal, std::span<const double> upper,
                       std::span<double> x);

/// The same for a closed chain: lower[0] couples the first row with the last unknown, upper[n-1] the last row with the
/// first (Sherman and Morrison). Needs n >= 3.
void solve_cyclic(std::span<const double> lower, std::span<const double> diagonal, std::span<const double> upper,
                  std::span<double> x);

/// A chain of points whose neighbours are tied by springs of length 0, open or closed. One coordinate at a time: such
/// springs do not mix them.
struct Chain {
  double stiffness = 1;
  bool closed = false;
};

/// One step of the generalised implicit Euler method (ODE-THETA, thesis 4.29-4.36) for y' = -grad E(y) + pull, first
/// order in time: (I/h + theta H) dy = -grad E + pull, H the Hessian of the springs' energy (E16: the printed sign
/// holds for H = df/dy only). theta 0 is explicit, 1 implicit and stable for any step, 1/2 of second order. `pull` has
/// one number per point, or none. Needs at least 2 points, 3 when closed.
void advance_chain(const Chain& chain, std::span<double> y, double h, double theta, std::span<const double> pull = {});

}  // namespace dynasurf::dynamics
