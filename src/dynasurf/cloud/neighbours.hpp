#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dynasurf/core/geometry.hpp"

namespace dynasurf {

/// Answers which points are nearest: exact, by a balanced tree that halves the points at medians. Equally near points
/// are told apart by their index, so answers are the same everywhere.
class Neighbours {
 public:
  struct Found {
    double distance2 = std::numeric_limits<double>::infinity();
    std::uint32_t index = 0xffffffff;
    bool operator<(const Found& o) const {
      return distance2 != o.distance2 ? distance2 < o.distance2 : index < o.index;
    }
  };

  /// Keeps its own copy of the points, which must be finite.
  explicit Neighbours(std::span<const Vec3> points);

  /// Fills `found` with the nearest points, nearest first; a point of the cloud finds itself. Returns how many there
  /// are: less than asked for when the cloud is smaller.
  std::size_t nearest(const Vec3& p, std::span<Found> found) const;
  /// The nearest point; infinity when there is none.
  Found nearest(const Vec3& p) const;

 private:
  struct Node {
    double split;
    std::uint32_t first, last;  // of `order_`
    std::int32_t axis;          // -1: a leaf
    std::uint32_t right;        // the left child follows its parent
  };
  std::uint32_t build(std::uint32_t first, std::uint32_t last, std::span<const Vec3> points);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
  std::vector<Vec3> sorted_;
};

/// The points' numbers along a curve that fills their box, so that those that follow each other lie near each other.
std::vector<std::uint32_t> along_curve(std::span<const Vec3> points);

}  // namespace dynasurf
