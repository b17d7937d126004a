#include "dynasurf/cloud/detail/kd_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "dynasurf/core/parallel.hpp"

namespace dynasurf::cloud {
namespace {

constexpr std::size_t leaf_size = 8;

/// Where part `m` of 2^level equal parts begins.
std::size_t part_begin(std::size_t count, std::size_t m, int level) { return count * m >> level; }

}  // namespace

KdTree::KdTree(std::span<const Vec3> points) {
  const std::vector<Place> places = sorted(points);
  own_.reserve(places.size());
  numbers_.reserve(places.size());
  for (const Place& place : places) {
    own_.push_back(place.point);
    numbers_.push_back(place.index);
  }
  points_ = own_;
}

KdTree::KdTree(std::vector<Vec3>& points, std::vector<std::uint32_t>& had) {
  const std::vector<Place> places = sorted(points);
  had.resize(places.size());
  for (std::size_t n = 0; n < places.size(); ++n) points[n] = places[n].point, had[n] = places[n].index;
  points_ = points;
}

/// The points in the order of a new tree.
std::vector<KdTree::Place> KdTree::sorted(std::span<const Vec3> points) {
  std::vector<Place> places(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) places[i].point = points[i], places[i].index = i;
  while ((points.size() >> depth_) > leaf_size) ++depth_;
  const std::size_t leaves = std::size_t{1} << depth_;
  splits_.resize(leaves - 1);
  first_.resize(leaves + 1);
  for (std::size_t l = 0; l <= leaves; ++l) first_[l] = part_begin(points.size(), l, depth_);
  for (int level = 0; level < depth_; ++level) split_level(places, level);
  // Each library leaves its own order within the leaves.
  parallel_for(leaves, std::max<std::size_t>(1, leaves / 64), [&](std::size_t begin, std::size_t end) {
    for (std::size_t l = begin; l < end; ++l)
      std::sort(places.begin() + first_[l], places.begin() + first_[l + 1],
                [](const Place& a, const Place& b) { return a.index < b.index; });
  });
  return places;
}

/// Halves every part of a level across its longest side.
void KdTree::split_level(std::vector<Place>& places, int level) {
  const std::size_t parts = std::size_t{1} << level;
  parallel_for(parts, std::max<std::size_t>(1, parts / 64), [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = begin; m < end; ++m) {
      const auto at = [&](std::size_t part, int of) { return places.begin() + part_begin(places.size(), part, of); };
      const auto first = at(m, level), middle = at(2 * m + 1, level + 1), last = at(m + 1, level);
      Eigen::AlignedBox3d box;
      for (auto i = first; i != last; ++i) box.extend(i->point);
      Eigen::Index axis = 0;
      box.sizes().maxCoeff(&axis);
      std::nth_element(first, middle, last, [axis](const Place& a, const Place& b) {
        // Equal coordinates go by their numbers, so that every library halves alike.
        return a.point[axis] != b.point[axis] ? a.point[axis] < b.point[axis] : a.index < b.index;
      });
      splits_[parts - 1 + m].at = middle->point[axis], splits_[parts - 1 + m].axis = axis;
    }
  });
}

std::size_t KdTree::nearest(const Vec3& p, std::span<Found> found, double within) const {
  std::fill(found.begin(), found.end(), Found{within * within});
  if (points_.empty() || found.empty()) return 0;
  struct Waiting {
    std::size_t node;
    double distance2;
  };
  std::array<Waiting, 64> stack;  // one a level, and each level halves the points
  std::size_t depth = 0, count = 0;
  stack[depth++] = {0, 0};
  // What the stores into `found` cannot change.
  const std::array<double, 3> place{p[0], p[1], p[2]};
  const std::span<const Split> splits = splits_;
  const std::span<const Vec3> points = points_;
  double farthest2 = within * within;
  while (depth > 0) {
    const Waiting top = stack[--depth];
    if (top.distance2 > farthest2) continue;
    std::size_t node = top.node;
    while (node < splits.size()) {
      const Split& split = splits[node];
      const double across = place[split.axis] - split.at;
      const std::size_t left = 2 * node + 1;
      stack[depth++] = {across < 0 ? left + 1 : left, std::max(top.distance2, across * across)};
      node = across < 0 ? left : left + 1;
    }
    const std::size_t leaf = node - splits.size();
    for (std::uint32_t i = first_[leaf], end = first_[leaf + 1]; i < end; ++i) {
      const double x = points[i][0] - place[0], y = points[i][1] - place[1], z = points[i][2] - place[2];
      const double distance2 = x * x + (y * y + z * z);
      if (distance2 > farthest2) continue;
      const Found f{distance2, number(i)};
      if (!(f < found.back())) continue;
      std::size_t k = std::min(count, found.size() - 1);
      for (; k > 0 && f < found[k - 1]; --k) found[k] = found[k - 1];
      found[k] = f;
      farthest2 = found.back().distance2;
      if (count < found.size()) ++count;
    }
  }
  return count;
}

KdTree::Found KdTree::nearest(const Vec3& p, double within) const {
  std::array<Found, 1> one;
  nearest(p, one, within);
  return one[0];
}

void KdTree::keep(std::span<const std::uint8_t> kept, std::span<const Vec3> left) {
  std::uint32_t at = 0;
  for (std::size_t leaf = 0; leaf + 1 < first_.size(); ++leaf) {
    const std::uint32_t first = first_[leaf], last = first_[leaf + 1];
    // The splits stay as they are: what is left of a leaf lies where it lay.
    first_[leaf] = at;
    for (std::uint32_t i = first; i < last; ++i) at += kept[i] != 0;
  }
  first_.back() = at;
  points_ = left;
}

double spacing_around(const KdTree& tree, const Vec3& point) {
  std::array<KdTree::Found, 13> found;  // itself first
  const std::size_t n = tree.nearest(point, found);
  return n < 2 ? 0 : std::sqrt(std::numbers::pi * found[n - 1].distance2 / (n - 1));
}

}  // namespace dynasurf::cloud
