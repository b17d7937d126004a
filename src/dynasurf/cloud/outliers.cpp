#include "dynasurf/cloud/detail/outliers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/detail/symmetric_axes.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::cloud {
namespace {

constexpr std::size_t ring_grain = 1024;

using Ring = std::array<std::uint32_t, stray_ring>;

struct Company {
  std::vector<double> distance;  // mean, to the neighbours
  std::vector<Ring> around;
};

Company company_of(const std::vector<Vec3>& points, const KdTree& neighbours) {
  Company c{std::vector<double>(points.size(), 0), std::vector<Ring>(points.size())};
  parallel_for(points.size(), ring_grain, [&](std::size_t begin, std::size_t end) {
    std::array<KdTree::Found, stray_ring + 1> found;
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t n = neighbours.nearest(points[i], found);
      for (std::size_t k = 1; k < n; ++k) {
        c.distance[i] += std::sqrt(found[k].distance2) / (n - 1);
        c.around[i][k - 1] = found[k].index;
      }
    }
  });
  return c;
}

/// The first point of the set that each point hangs together with.
std::vector<std::uint32_t> sets_of(const std::vector<Ring>& around) {
  // Of each ring those that have the point in theirs too, and come before it.
  std::vector<std::uint8_t> both(around.size(), 0);
  static_assert(stray_ring <= 8);
  parallel_for(around.size(), ring_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = 0; k < stray_ring; ++k) {
        const std::uint32_t j = around[i][k];
        if (j < i && std::find(around[j].begin(), around[j].end(), i) != around[j].end()) both[i] |= 1U << k;
      }
  });
  std::vector<std::uint32_t> first(around.size());
  std::iota(first.begin(), first.end(), 0u);
  const auto root = [&](std::uint32_t i) {
    while (first[i] != i) i = first[i] = first[first[i]];
    return i;
  };
  for (std::uint32_t i = 0; i < around.size(); ++i)
    for (std::size_t k = 0; k < stray_ring; ++k) {
      if (!(both[i] & 1U << k)) continue;
      const std::uint32_t a = root(i), b = root(around[i][k]);
      first[std::max(a, b)] = std::min(a, b);
    }
  for (std::uint32_t i = 0; i < around.size(); ++i) first[i] = root(i);
  return first;
}

/// How thick the neighbourhoods of some points are, seen among these points alone: 0 in a plane, 1/3 at most.
double thickness_of(const std::vector<Vec3>& points) {
  constexpr std::size_t neighbourhood = 13, asked = 200;
  const KdTree tree(points);
  const std::size_t step = std::max<std::size_t>(1, points.size() / asked);
  std::vector<double> thickness;
  for (std::size_t i = 0; i < points.size(); i += step) {
    std::array<KdTree::Found, neighbourhood> found;
    const std::size_t n = tree.nearest(points[i], found);
    Vec3 middle = Vec3::Zero();
    for (std::size_t k = 0; k < n; ++k) middle += points[found[k].index] / (1.0 * n);
    Mat3 spread = Mat3::Zero();
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3 off = points[found[k].index] - middle;
      spread += off * off.transpose();
    }
    const Vec3 axes = symmetric_axes(spread).values;
    thickness.push_back(axes.sum() > 0 ? axes[0] / axes.sum() : 0);
  }
  return upper_median(std::move(thickness));
}

/// Whether the points `some` of one set are too few or fill space.
bool is_scattered(const std::vector<Vec3>& points, const Company& c, std::span<const std::uint32_t> some,
                  double limit) {
  constexpr std::size_t fewest = 2 * stray_ring;
  constexpr double thick = 0.05;
  if (some.size() < fewest) return true;
  std::vector<Vec3> places;
  std::vector<double> distances;
  for (const std::uint32_t i : some) {
    places.push_back(points[i]);
    distances.push_back(c.distance[i]);
  }
  return upper_median(std::move(distances)) > limit && thickness_of(places) > thick;
}

/// Drops the sparse points of sets that are no surface.
void drop_scattered(const std::vector<Vec3>& points, const Company& c, double factor, std::vector<std::uint8_t>& kept) {
  constexpr double large_share = 0.1;
  const std::vector<std::uint32_t> set = sets_of(c.around);
  std::vector<std::uint32_t> size(points.size(), 0), small;
  for (const std::uint32_t s : set) ++size[s];
  const std::uint32_t largest = std::max_element(size.begin(), size.end()) - size.begin();
  std::vector<double> usual;
  usual.reserve(size[largest]);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (set[i] == largest)
      usual.push_back(c.distance[i]);
    else if (size[set[i]] < large_share * points.size())
      small.push_back(i);
  }
  const double limit = factor * upper_median(std::move(usual));
  std::sort(small.begin(), small.end(),
            [&](std::uint32_t a, std::uint32_t b) { return set[a] != set[b] ? set[a] < set[b] : a < b; });
  for (std::size_t begin = 0; begin < small.size(); begin += size[set[small[begin]]]) {
    const auto some = std::span<const std::uint32_t>(small).subspan(begin, size[set[small[begin]]]);
    if (!is_scattered(points, c, some, limit)) continue;
    for (const std::uint32_t i : some)
      if (c.distance[i] > limit) kept[i] = 0;
  }
}

}  // namespace

std::vector<std::uint8_t> parts_of_surfaces(const std::vector<Vec3>& points, const KdTree& neighbours, double factor) {
  const Company c = company_of(points, neighbours);
  std::vector<std::uint8_t> kept(points.size(), 1);
  parallel_for(points.size(), ring_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double usual = 0;
      for (const std::uint32_t j : c.around[i]) usual += c.distance[j] / stray_ring;
      kept[i] = c.distance[i] <= factor * usual;
    }
  });
  drop_scattered(points, c, 0.5 * factor, kept);
  return kept;
}

}  // namespace dynasurf::cloud
