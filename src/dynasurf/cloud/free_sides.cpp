#include "dynasurf/cloud/detail/free_sides.hpp"

#include <algorithm>
#include <array>

#include "dynasurf/core/grid.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::cloud {
namespace {

/// The cells of a lattice that hold points.
class Occupied {
 public:
  Occupied(const std::vector<Vec3>& points, double cell) : cell_(cell) {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : points) box.extend(p);
    low_ = box.min();
    for (int a = 0; a < 3; ++a) counts_[a] = static_cast<std::size_t>(box.sizes()[a] / cell) + 1;
    is_in_.assign(counts_[0] * counts_[1] * counts_[2], 0);
    for (const Vec3& p : points) is_in_[*cell_of(p)] = 1;
  }

  /// Whether a ray meets one, from `nearest` cells on.
  bool meets(const Vec3& from, const Vec3& along, double nearest) const {
    constexpr double step = 0.5;
    for (double at = nearest;; at += step) {
      const std::optional<std::size_t> in = cell_of(from + at * cell_ * along);
      if (!in) return false;
      if (is_in_[*in]) return true;
    }
  }

 private:
  std::optional<std::size_t> cell_of(const Vec3& p) const {
    std::size_t index = 0;
    for (const std::size_t a : {2, 1, 0}) {
      const double at = (p[a] - low_[a]) / cell_;
      if (!(at >= 0) || at >= counts_[a]) return std::nullopt;
      index = index * counts_[a] + static_cast<std::size_t>(at);
    }
    return index;
  }

  double cell_;
  Vec3 low_;
  std::array<std::size_t, 3> counts_{};
  std::vector<std::uint8_t> is_in_;
};

}  // namespace

std::vector<std::int8_t> free_sides(const OrientedPoints& points, double cell) {
  constexpr double nearest = 4;
  const Occupied occupied(points.points, cell);
  std::vector<std::int8_t> sides(points.points.size());
  parallel_for(sides.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 &p = points.points[i], &n = points.normals[i];
      sides[i] = occupied.meets(p, -n, nearest) - occupied.meets(p, n, nearest);
    }
  });
  return sides;
}

std::optional<OrientedPoints> turned_to_free_sides(const OrientedPoints& points, double cell) {
  constexpr double most = 0.6, many = 0.1;
  const std::vector<std::int8_t> sides = free_sides(points, cell);
  const double count = sides.size(), against = std::count(sides.begin(), sides.end(), -1);
  const double one_sided = count - std::count(sides.begin(), sides.end(), 0);
  if (one_sided < most * count || against < many * count) return std::nullopt;
  PointCloud told{points.points, points.normals, {}, {}, {}};
  for (std::size_t i = 0; i < sides.size(); ++i) told.normals[i] *= sides[i];
  return orient(told, true);
}

}  // namespace dynasurf::cloud
