#include "dynasurf/dynamics/solvers/detail/conjugate_gradients.hpp"

#include <cmath>

#include "dynasurf/core/parallel.hpp"

namespace dynasurf::dynamics {
namespace {

constexpr std::size_t kSumGrain = 2048;

double dot(std::span<const Vec3> a, std::span<const Vec3> b) {
  return parallel_sum(a.size(), kSumGrain, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += a[i].dot(b[i]);
    return sum;
  });
}

}  // namespace

CgResult conjugate_gradients(const std::function<void(std::span<const Vec3>, std::span<Vec3>)>& multiply,
                             std::span<const Mat3> inverse_diagonal, std::span<const Vec3> b, std::span<Vec3> x,
                             double tolerance, int max_iterations) {
  const std::size_t n = b.size();
  CgResult result;
  std::fill(x.begin(), x.end(), Vec3::Zero());
  std::vector<Vec3> left(b.begin(), b.end()), better(n), direction(n), image(n);
  const double whole = std::sqrt(dot(b, b));
  if (!(whole > 0)) {
    result.converged = whole == 0;
    return result;
  }
  for (std::size_t i = 0; i < n; ++i) direction[i] = better[i] = inverse_diagonal[i] * left[i];
  double energy = dot(left, better);
  result.residual = 1;
  while (result.iterations < max_iterations) {
    multiply(direction, image);
    const double curvature = dot(direction, image);
    if (!(curvature > 0)) {
      result.is_definite = false;
      return result;
    }
    ++result.iterations;
    const double way = energy / curvature;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += way * direction[i];
      left[i] -= way * image[i];
      better[i] = inverse_diagonal[i] * left[i];
    }
    result.residual = std::sqrt(dot(left, left)) / whole;
    if (result.residual <= tolerance) {
      result.converged = true;
      return result;
    }
    const double former = energy;
    energy = dot(left, better);
    for (std::size_t i = 0; i < n; ++i) direction[i] = better[i] + energy / former * direction[i];
  }
  return result;
}

}  // namespace dynasurf::dynamics
