#pragma once
#include <span>

namespace dynasurf::dynamics {

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
