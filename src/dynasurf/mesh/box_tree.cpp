#include "dynasurf/mesh/detail/box_tree.hpp"

#include <algorithm>
#include <numeric>

namespace dynasurf::mesh {
namespace {

constexpr std::uint32_t boxes_a_leaf = 4;

}  // namespace

BoxTree::BoxTree(const std::vector<Box>& boxes) : order_(boxes.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (!order_.empty()) build(boxes, 0, order_.size());
}

// Halves a group across the longest side of its middles.
void BoxTree::build(const std::vector<Box>& boxes, std::uint32_t first, std::uint32_t last) {
  const std::size_t n = nodes_.size();
  const auto at = [this](std::uint32_t i) { return order_.begin() + i; };
  Box box, middles;
  for (std::uint32_t i = first; i < last; ++i) {
    const Box& b = boxes[order_[i]];
    box.hold(b);
    middles.hold(Vec3(b.low + b.high));
  }
  nodes_.push_back({box, first, last, 0, last - first <= boxes_a_leaf});
  if (last - first > boxes_a_leaf) {
    Eigen::Index axis = 0;
    (middles.high - middles.low).maxCoeff(&axis);
    const std::uint32_t middle = first + (last - first) / 2;
    std::nth_element(at(first), at(middle), at(last), [&](std::uint32_t s, std::uint32_t t) {
      const double a = boxes[s].low[axis] + boxes[s].high[axis], b = boxes[t].low[axis] + boxes[t].high[axis];
      return a != b ? a < b : s < t;
    });
    build(boxes, first, middle);
    build(boxes, middle, last);
  } else {  // each library leaves its own order
    std::sort(at(first), at(last));
  }
  nodes_[n].end = nodes_.size();
}

}  // namespace dynasurf::mesh
