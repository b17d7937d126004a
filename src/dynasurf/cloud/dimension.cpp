#include "dynasurf/cloud/detail/dimension.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::cloud {
namespace {

constexpr int scales = 14;
constexpr double widest = 0.5;  // of the mean distance from the middle; each scale is smaller by the root of 2

using Counts = std::array<double, scales>;  // pairs within each scale, widest first

/// Of a normal number; `std::ilogb` is a call.
int exponent_of(double x) { return static_cast<int>(std::bit_cast<std::uint64_t>(x) >> 52 & 0x7ff) - 1023; }

Counts pairs_within(std::span<const Vec3> points) {
  constexpr std::size_t centres = 300, others = 20000;
  const double share = 1.0 / points.size();
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : points) middle += share * p;
  double spread = 0;
  for (const Vec3& p : points) spread += share * (p - middle).squaredNorm();
  const double largest = widest * widest * spread;
  const std::size_t step = std::max<std::size_t>(1, points.size() / others);
  const std::size_t stride = std::max<std::size_t>(1, points.size() / centres);
  std::vector<Vec3> some;
  for (std::size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
  std::vector<Counts> of_centre((points.size() + stride - 1) / stride, Counts{});
  parallel_for(of_centre.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      for (std::size_t i = 0; i < some.size(); ++i) {
        const double distance2 = (some[i] - points[c * stride]).squaredNorm();
        if (distance2 > largest || i * step == c * stride) continue;
        const int scale = std::min(exponent_of(largest / std::max(distance2, 1e-9 * largest)), scales - 1);
        ++of_centre[c][scale];
      }
  });
  Counts sum{};
  for (const Counts& counts : of_centre)
    for (std::size_t s = 0; s < scales; ++s) sum[s] += counts[s] / of_centre.size();
  for (std::size_t s = scales - 1; s > 0;) {
    --s;
    sum[s] += sum[s + 1];
  }
  return sum;
}

}  // namespace

double smallest_dimension(std::span<const Vec3> points) {
  constexpr std::size_t fewest = 100;
  constexpr double few = 2;
  if (points.size() < fewest) return 0;
  const Counts counts = pairs_within(points);
  double smallest = 3;
  for (std::size_t s = 0; s + 2 < scales && counts[s + 2] >= few; ++s)
    smallest = std::min(smallest, own::log2(counts[s] / counts[s + 2]));
  return counts[2] >= few ? smallest : 0;
}

}  // namespace dynasurf::cloud
