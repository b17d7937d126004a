#pragma once
#include <cstddef>
#include <span>
#include <string_view>
#include <variant>

#include "dynasurf/core/options.hpp"

namespace dynasurf::dynamics {

// Solvers (thesis chapter 4). Each advances y' = f(y) by one step.
struct Euler {
  static constexpr std::string_view name = "euler";
};
/// Two slopes a step, the second in its middle: second order.
struct Midpoint {
  static constexpr std::string_view name = "midpoint";
};
/// Four slopes a step: fourth order.
struct Rk4 {
  static constexpr std::string_view name = "rk4";
};
void describe(auto&, Euler&) {}
void describe(auto&, Midpoint&) {}
void describe(auto&, Rk4&) {}

/// What step doubling makes its steps with.
enum class BaseMethod { euler, midpoint, rk4 };
std::span<const std::string_view> names_of(BaseMethod);

/// Step doubling (ODE-ADAPT, thesis 4.2.4): one step of 2h against two of h tells the error, and the error the next h.
/// A step of the run is cut into as many as the tolerance asks for.
struct StepDoubling {
  static constexpr std::string_view name = "step_doubling";
  BaseMethod base = BaseMethod::rk4;
  double tolerance = 1e-3;
  bool extrapolate = false;
};
void describe(auto& visit, StepDoubling& o) {
  visit("base", o.base, OptionInfo{"method of the single steps"});
  visit("tolerance", o.tolerance,
        OptionInfo{"largest error of a step: of places, and of the way that speeds lead to before the drag ends it",
                   "mm", 1e-12, 1e9});
  visit("extrapolate", o.extrapolate, OptionInfo{"use the error to gain one order (local extrapolation)"});
}

/// Runge-Kutta-Fehlberg 4(5) (FUT-ADAPTRK): two orders from six slopes; advances with the fifth.
struct Rkf45 {
  static constexpr std::string_view name = "rkf45";
  double tolerance = 1e-3;
};
void describe(auto& visit, Rkf45& o) {
  visit("tolerance", o.tolerance,
        OptionInfo{"largest error of a step: of places, and of the way that speeds lead to before the drag ends it",
                   "mm", 1e-12, 1e9});
}

/// `exact` keeps the second derivatives of the conditions as long as the system stays positive definite, and does
/// without them when not.
enum class Stiffening { definite, exact };
std::span<const std::string_view> names_of(Stiffening);

/// Linearised backward Euler with conjugate gradients (ODE-BEULER, thesis 4.4, eqs 4.37-4.46).
struct BackwardEuler {
  static constexpr std::string_view name = "backward_euler";
  double tolerance = 1e-6;
  int max_iterations = 0;
  Stiffening stiffness = Stiffening::definite;
};
void describe(auto& visit, BackwardEuler& o) {
  visit("tolerance", o.tolerance,
        OptionInfo{"residual of the linear system at which it is solved, of the right side", "", 1e-14, 0.5});
  visit("max_iterations", o.max_iterations,
        OptionInfo{"of conjugate gradients per step; 0: three per particle", "", 0, 100000000});
  visit("stiffness", o.stiffness,
        OptionInfo{
            "definite: second derivatives only where they keep the system definite; exact: all, as long as it is"});
}

/// What suits the model (ODE-CHOICE, see `solver_for`).
struct AutomaticSolver {
  static constexpr std::string_view name = "automatic";
};
void describe(auto&, AutomaticSolver&) {}

/// One of the solvers.
using SolverOptions = std::variant<Euler, Midpoint, Rk4, StepDoubling, Rkf45, BackwardEuler, AutomaticSolver>;

/// The largest stable step of a solver for the drag alone: 2 m/k_d for Euler and midpoint, 2.785 m/k_d for RK4, with
/// m = mass / n (ODE-LIMIT, thesis table 4.2). Infinity without drag, and for the other solvers.
double step_limit_s(const SolverOptions& solver, double mass_kg, std::size_t particles, double drag);

}  // namespace dynasurf::dynamics
