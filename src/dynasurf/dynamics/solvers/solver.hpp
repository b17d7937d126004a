#pragma once
#include <functional>
#include <limits>
#include <span>

#include "dynasurf/dynamics/solvers/detail/solver_options.hpp"

namespace dynasurf::dynamics {

/// A system of ordinary differential equations y' = f(y) (ODE-IFACE, thesis 4.1): writes f(y) to `dydt`, of the same
/// length. A solver knows nothing of forces; particles are laid out as the system likes.
using Derivative = std::function<void(std::span<const double> y, std::span<double> dydt)>;

/// A solver works in at most so many times the length of y.
inline constexpr std::size_t kSolverScratch = 8;

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

/// One accepted step of a solver that controls its error (A.7).
struct AdaptiveStep {
  double taken = 0;  // by which y was advanced, at most what was asked for
  double next = 0;   // what to try next
  double error = 0;  // of the accepted step, in tolerances: the worst unknown's
  int rejected = 0;  // steps tried in vain
};

/// Tries a step of `h`, and shorter ones until no unknown errs by more than its tolerance; 0.9 of the step that just
/// would do is tried next, between 0.1 and 5 times the present one. `tolerance` holds one number for every unknown, or
/// one for all. A step that falls below 1e-12 h is taken as it is: the right side is not smooth, or not finite, there.
AdaptiveStep advance_once(const StepDoubling&, std::span<double> y, double h, std::span<const double> tolerance,
                          const Derivative& f, std::span<double> scratch);
AdaptiveStep advance_once(const Rkf45&, std::span<double> y, double h, std::span<const double> tolerance,
                          const Derivative& f, std::span<double> scratch);

/// End of the interval of z = h * rate in which y' = -rate y does not grow: 2 for Euler and midpoint, 2.785 for RK4,
/// infinity for solvers that control their error or are implicit.
double stability_interval(const SolverOptions& solver);

/// The largest h with which x'' = -damping x' - stiffness x (1/s and 1/s2, not negative) does not grow: what an
/// oscillator allows. Zero when every step grows, which Euler's does without damping.
double oscillator_limit_s(const SolverOptions& solver, double stiffness, double damping);

}  // namespace dynasurf::dynamics
