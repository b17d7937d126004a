#include "dynasurf/cloud/detail/by_cell.hpp"

#include <algorithm>
#include <numeric>

#include "dynasurf/core/parallel.hpp"

namespace dynasurf::cloud {

std::vector<InCell> by_cell(std::span<const Vec3> points, const Vec3& origin, double side) {
  constexpr int bits = 21;  // of the cells along an axis
  constexpr std::size_t grain = 1024;
  std::vector<InCell> cells(points.size());
  parallel_for(cells.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 place = (points[i] - origin) / side;
      const std::uint64_t x = place[0], y = place[1], z = place[2];
      cells[i].cell = z << 2 * bits | y << bits | x;
      cells[i].index = i;
    }
  });
  // Into slabs first, so that several processors can sort.
  std::uint64_t slabs = 0;
  for (const InCell& c : cells) slabs = std::max(slabs, (c.cell >> 2 * bits) + 1);
  std::vector<std::uint32_t> first(slabs + 2, 0);
  for (const InCell& c : cells) ++first[(c.cell >> 2 * bits) + 2];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<InCell> order(cells.size());
  for (const InCell& c : cells) order[first[(c.cell >> 2 * bits) + 1]++] = c;
  parallel_for(slabs, 1 + slabs / 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      std::sort(order.begin() + first[s], order.begin() + first[s + 1], [](const InCell& a, const InCell& b) {
        return a.cell != b.cell ? a.cell < b.cell : a.index < b.index;
      });
  });
  return order;
}

}  // namespace dynasurf::cloud
