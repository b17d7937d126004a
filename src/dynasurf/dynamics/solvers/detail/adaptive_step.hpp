#pragma once
#include <cstddef>
#include <functional>
#include <span>

#include "dynasurf/dynamics/solvers/detail/solver_options.hpp"

namespace dynasurf::dynamics {

/// A system of ordinary differential equations y' = f(y) (ODE-IFACE, thesis 4.1): writes f(y) to `dydt`, of the same
/// length. A solver knows nothing of forces; particles are laid out as the system likes.
using Derivative = std::function<void(std::span<const double> y, std::span<double> dydt)>;

/// A solver works in at most so many times the length of y.
inline constexpr std::size_t kSolverScratch = 8;

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

}  // namespace dynasurf::dynamics
