#include "dynasurf/cloud/neighbours.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace dynasurf {
namespace {
constexpr std::uint32_t leaf_size = 10;

/// The bits of a number of 16 bits, two zeros after each.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32) & 0x1f00000000ffffu;
  x = (x | x << 16) & 0x1f0000ff0000ffu;
  x = (x | x << 8) & 0x100f00f00f00f00fu;
  x = (x | x << 4) & 0x10c30c30c30c30c3u;
  return (x | x << 2) & 0x1249249249249249u;
}
}  // namespace

Neighbours::Neighbours(std::span<const Vec3> points) : order_(points.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (!points.empty()) build(0, static_cast<std::uint32_t>(points.size()), points);
  sorted_.reserve(points.size());
  for (const std::uint32_t i : order_) sorted_.push_back(points[i]);
}

std::uint32_t Neighbours::build(std::uint32_t first, std::uint32_t last, std::span<const Vec3> points) {
  const auto node = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({0, first, last, -1, 0});
  if (last - first <= leaf_size) return node;
  Eigen::AlignedBox3d box;
  for (std::uint32_t i = first; i < last; ++i) box.extend(points[order_[i]]);
  Eigen::Index axis = 0;
  if (box.sizes().maxCoeff(&axis) <= 0) return node;
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](std::uint32_t a, std::uint32_t b) {
                     return points[a][axis] != points[b][axis] ? points[a][axis] < points[b][axis] : a < b;
                   });
  const double split = points[order_[middle]][axis];
  build(first, middle, points);
  const std::uint32_t right = build(middle, last, points);
  nodes_[node].split = split;
  nodes_[node].axis = static_cast<std::int32_t>(axis);
  nodes_[node].right = right;
  return node;
}

std::size_t Neighbours::nearest(const Vec3& p, std::span<Found> found) const {
  std::fill(found.begin(), found.end(), Found{});
  if (nodes_.empty() || found.empty()) return 0;
  struct Waiting {
    std::uint32_t node;
    double distance2;
  };
  std::array<Waiting, 64> stack;
  std::size_t depth = 0, count = 0;
  stack[depth++] = {0, 0};
  while (depth > 0) {
    Waiting at = stack[--depth];
    if (at.distance2 > found.back().distance2) continue;
    const Node* n = &nodes_[at.node];
    while (n->axis >= 0) {
      const double across = p[n->axis] - n->split;
      const std::uint32_t left = at.node + 1;
      stack[depth++] = {across < 0 ? n->right : left, std::max(at.distance2, across * across)};
      at.node = across < 0 ? left : n->right;
      n = &nodes_[at.node];
    }
    for (std::uint32_t i = n->first; i < n->last; ++i) {
      const Found f{(sorted_[i] - p).squaredNorm(), order_[i]};
      if (!(f < found.back())) continue;
      std::size_t k = std::min(count, found.size() - 1);
      for (; k > 0 && f < found[k - 1]; --k) found[k] = found[k - 1];
      found[k] = f;
      if (count < found.size()) ++count;
    }
  }
  return count;
}

Neighbours::Found Neighbours::nearest(const Vec3& p) const {
  std::array<Found, 1> one;
  nearest(p, one);
  return one[0];
}

std::vector<std::uint32_t> along_curve(std::span<const Vec3> points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points) box.extend(p);
  const double scale = 65535 / std::max(points.empty() ? 0 : box.sizes().maxCoeff(), 1e-300);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 q = scale * (points[i] - box.min());
    const auto bits = [](double x) { return spread(static_cast<std::uint64_t>(x)); };
    keyed[i] = {bits(q[0]) | bits(q[1]) << 1 | bits(q[2]) << 2, static_cast<std::uint32_t>(i)};
  }
  std::sort(keyed.begin(), keyed.end());
  std::vector<std::uint32_t> order;
  order.reserve(keyed.size());
  for (const auto& [key, i] : keyed) order.push_back(i);
  return order;
}

}  // namespace dynasurf
