#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dynasurf/core/grid.hpp"

namespace dynasurf::cloud {

/// Answers which points are nearest: exact, by a balanced tree that halves the points at medians. Equally near points
/// are told apart by their index, so answers are the same everywhere.
class KdTree {
 public:
  struct Found {
    double distance2 = std::numeric_limits<double>::infinity();
    std::uint32_t index = 0xffffffff;
    bool operator<(const Found& o) const {
      return distance2 != o.distance2 ? distance2 < o.distance2 : index < o.index;
    }
  };

  /// A point and its number in the cloud.
  struct Place {
    Vec3 point;
    std::uint32_t index;
  };

  /// Keeps its own copy of the points, which must be finite.
  explicit KdTree(std::span<const Vec3> points);

  /// Fills `found` with the nearest points, nearest first; a point of the cloud finds itself. Returns how many there
  /// are: less than asked for when the cloud is smaller, or has fewer nearer than `within`, which saves far places from
  /// a long search.
  std::size_t nearest(const Vec3& p, std::span<Found> found,
                      double within = std::numeric_limits<double>::infinity()) const;
  /// The nearest point; at `within` when none is nearer.
  Found nearest(const Vec3& p, double within = std::numeric_limits<double>::infinity()) const;

  /// The points in the order of the tree: near ones follow each other, so that questions asked in this order find most
  /// of what they need at hand, and every so many of them still cover all of the surface.
  std::span<const Place> places() const { return places_; }
  /// Numbers the points in the order of the tree, and returns which number each of them had.
  std::vector<std::uint32_t> renumber();
  /// Forgets the points whose number is not kept; the others are numbered anew, in their order.
  void keep(std::span<const std::uint8_t> kept);

 private:
  struct Split {
    double at;
    std::uint32_t axis;
  };
  void split_level(int level);

  int depth_ = 0;
  std::vector<Split> splits_;         // node n has the children 2 n + 1 and 2 n + 2; the leaves follow the inner nodes
  std::vector<std::uint32_t> first_;  // of `places_`, per leaf and at the end
  std::vector<Place> places_;
};

}  // namespace dynasurf::cloud
