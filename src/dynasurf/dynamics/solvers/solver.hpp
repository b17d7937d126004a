#pragma once
#include <functional>
#include <span>

#include "dynasurf/dynamics/evolve.hpp"

namespace dynasurf {

/// A system of ordinary differential equations y' = f(y) (ODE-IFACE, thesis 4.1): writes f(y) to `dydt`, of the same
/// length. A solver knows nothing of forces; particles are laid out as the system likes.
using Derivative = std::function<void(std::span<const double> y, std::span<double> dydt)>;

/// A solver works in at most so many times the length of y.
inline constexpr std::size_t kSolverScratch = 3;

/// Advances y by one step of `h`. `scratch` holds at least kSolverScratch * y.size() numbers, whose contents are lost.
/// Global errors are of order h, h^2 and h^4.
void advance(const Euler&, std::span<double> y, double h, const Derivative& f, std::span<double> scratch);
void advance(const Midpoint&, std::span<double> y, double h, const Derivative& f, std::span<double> scratch);
void advance(const Rk4&, std::span<double> y, double h, const Derivative& f, std::span<double> scratch);
void advance(const SolverOptions&, std::span<double> y, double h, const Derivative& f, std::span<double> scratch);

/// End of the interval of z = h * rate in which y' = -rate y does not grow: 2 for Euler and midpoint, 2.785 for RK4.
double stability_interval(const SolverOptions& solver);

}  // namespace dynasurf
