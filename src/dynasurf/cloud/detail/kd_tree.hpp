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

  /// Keeps its own copy of the points, which must be finite.
  explicit KdTree(std::span<const Vec3> points);
  /// Brings the points into the order of the tree and numbers them so; `had` becomes the number that each of them had.
  /// The tree looks at them instead of at a copy: they must outlive it and stay.
  KdTree(std::vector<Vec3>& points, std::vector<std::uint32_t>& had);
  KdTree(KdTree&&) = default;
  KdTree& operator=(KdTree&&) = default;

  /// Fills `found` with the nearest points, nearest first; a point of the cloud finds itself. Returns how many there
  /// are: less than asked for when the cloud is smaller, or has fewer nearer than `within`, which saves far places from
  /// a long search.
  std::size_t nearest(const Vec3& p, std::span<Found> found,
                      double within = std::numeric_limits<double>::infinity()) const;
  /// The nearest point; at `within` when none is nearer.
  Found nearest(const Vec3& p, double within = std::numeric_limits<double>::infinity()) const;

  /// The points in the order of the tree: near ones follow each other, so that questions asked in this order find most
  /// of what they need at hand, and every so many of them still cover all of the surface.
  std::span<const Vec3> points() const { return points_; }
  /// The number in the cloud of the point that is the n-th in the order of the tree.
  std::uint32_t number(std::size_t n) const { return numbers_.empty() ? static_cast<std::uint32_t>(n) : numbers_[n]; }

  /// Forgets the points that are not kept, of a tree that looks at points in its order; `left` are the others, which it
  /// looks at from now on.
  void keep(std::span<const std::uint8_t> kept, std::span<const Vec3> left);

 private:
  struct Place {
    Vec3 point;
    std::uint32_t index;
  };
  struct Split {
    double at;
    std::uint32_t axis;
  };
  std::vector<Place> sorted(std::span<const Vec3> points);
  void split_level(std::vector<Place>& places, int level);

  int depth_ = 0;
  std::vector<Split> splits_;         // node n has the children 2 n + 1 and 2 n + 2; the leaves follow the inner nodes
  std::vector<std::uint32_t> first_;  // of the points, per leaf and at the end
  std::vector<Vec3> own_;
  std::span<const Vec3> points_;
  std::vector<std::uint32_t> numbers_;  // of the points in the cloud; none: as they stand
};

/// The side of the square that each point stands for around one of them, as its twelve nearest neighbours lie; 0 where
/// it has none.
double spacing_around(const KdTree& tree, const Vec3& point);

}  // namespace dynasurf::cloud
