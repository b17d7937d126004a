#include "dynasurf/mesh/edge_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::mesh {

std::vector<std::uint32_t> order_around(const Vec3& vertex, const Vec3& normal, std::span<const Vec3> neighbours) {
  constexpr double on_normal = 1e-12;  // of the way to a neighbour
  const Vec3 n = normal.normalized();
  const double none = std::numeric_limits<double>::infinity();
  std::vector<double> angle(neighbours.size(), none);
  Vec3 first = Vec3::Zero(), second = Vec3::Zero();
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    const Vec3 way = neighbours[i] - vertex, flat = way - way.dot(n) * n;
    if (flat.norm() <= on_normal * way.norm()) continue;
    if (first.isZero()) {
      first = flat.normalized();
      second = first.cross(n);
      angle[i] = 0;  // not a rounding below a full turn
      continue;
    }
    angle[i] = own::atan2(way.dot(second), way.dot(first));
    if (angle[i] < 0) angle[i] += 2 * std::numbers::pi;
  }
  std::vector<std::uint32_t> order(neighbours.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return angle[a] < angle[b]; });
  return order;
}

}  // namespace dynasurf::mesh
