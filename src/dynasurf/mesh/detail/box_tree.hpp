#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::mesh {

/// A box along the axes; without points it holds nothing.
struct Box {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  void hold(const Vec3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void hold(const Box& b) {
    low = low.cwiseMin(b.low);
    high = high.cwiseMax(b.high);
  }
  bool meets(const Box& b) const {
    return (low.array() <= b.high.array()).all() && (b.low.array() <= high.array()).all();
  }
};

/// Boxes around ever smaller groups of things that have boxes, such as the triangles of a mesh. The things of a leaf
/// are a run of `order()`, by number. Building costs O(n log n). Nearest points have a tree of their own, four boxes
/// wide for vector instructions: closest_point.hpp.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<Box>& boxes);

  /// The things, leaf by leaf.
  const std::vector<std::uint32_t>& order() const { return order_; }

  /// Calls `visit` with the place in `order()` of every thing in the leaves whose boxes, and all boxes around them,
  /// `enters(box)` lets in. It is asked box by box, so what was visited may change its answers.
  template <class Enters, class Visit>
  void walk(const Enters& enters, const Visit& visit) const {
    for (std::uint32_t n = 0; n < nodes_.size();) {
      const Node& node = nodes_[n];
      if (!enters(node.box)) {
        n = node.end;
        continue;
      }
      if (node.is_leaf)
        for (std::uint32_t i = node.first; i < node.last; ++i) visit(i);
      ++n;
    }
  }

 private:
  /// Children follow their parent; `end` tells where to go on when a box is not entered.
  struct Node {
    Box box;
    std::uint32_t first, last, end;
    bool is_leaf;
  };

  void build(const std::vector<Box>& boxes, std::uint32_t first, std::uint32_t last);

  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace dynasurf::mesh
