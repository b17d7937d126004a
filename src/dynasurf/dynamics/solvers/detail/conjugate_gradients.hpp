#pragma once
#include <functional>
#include <span>
#include <vector>

#include "dynasurf/core/grid.hpp"

namespace dynasurf::dynamics {

struct CgResult {
  int iterations = 0;
  double residual = 0;  // length of b - A x, of that of b
  bool converged = false;
  bool is_definite = true;  // false: a direction with d.Ad <= 0 was met, and x is what had been found before it
};

/// Solves A x = b for a symmetric positive definite A of 3x3 blocks by conjugate gradients, preconditioned with the
/// inverses of its diagonal blocks. `multiply(x, y)` writes A x. Starts from x = 0. The same bytes for any number of
/// threads, as far as `multiply` gives them.
CgResult conjugate_gradients(const std::function<void(std::span<const Vec3>, std::span<Vec3>)>& multiply,
                             std::span<const Mat3> inverse_diagonal, std::span<const Vec3> b, std::span<Vec3> x,
                             double tolerance, int max_iterations);

}  // namespace dynasurf::dynamics
