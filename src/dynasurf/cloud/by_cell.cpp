#include "dynasurf/cloud/detail/by_cell.hpp"

#include <algorithm>

#include "dynasurf/core/parallel.hpp"

namespace dynasurf::cloud {

std::vector<InCell> by_cell(std::span<const Vec3> points, const Vec3& origin, double side) {
  std::vector<InCell> order(points.size());
  parallel_for(order.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 place = (points[i] - origin) / side;
      const std::uint64_t x = place[0], y = place[1], z = place[2];
      order[i].cell = z << 42 | y << 21 | x;
      order[i].index = i;
    }
  });
  std::sort(order.begin(), order.end(),
            [](const InCell& a, const InCell& b) { return a.cell != b.cell ? a.cell < b.cell : a.index < b.index; });
  return order;
}

}  // namespace dynasurf::cloud
