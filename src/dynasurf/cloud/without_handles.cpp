#include <algorithm>
#include <array>
#include <queue>

#include "dynasurf/cloud/detail/body.hpp"

namespace dynasurf::cloud {
namespace {

/// The 27 nodes around a node: 1 inside. Number 13 is the node itself.
using Block = std::array<std::uint8_t, 27>;

std::array<int, 3> offset_of(int n) { return {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1}; }

int reach_of(int n) {
  const auto [x, y, z] = offset_of(n);
  return std::abs(x) + std::abs(y) + std::abs(z);
}

bool touch(int m, int n, bool inside) {
  const auto a = offset_of(m), b = offset_of(n);
  const int x = std::abs(a[0] - b[0]), y = std::abs(a[1] - b[1]), z = std::abs(a[2] - b[2]);
  return inside ? x + y + z == 1 : std::max({x, y, z}) <= 1;
}

/// How many groups of one kind of nodes touch the middle. Inside nodes hold together across faces, and only those
/// within two steps count; outside nodes hold together across edges and corners, too.
int groups(const Block& block, std::uint8_t kind) {
  const bool inside = kind == 1;
  std::array<std::uint8_t, 27> seen{};
  int count = 0;
  for (int start = 0; start < 27; ++start) {
    if (start == 13 || block[start] != kind || seen[start] || (inside && reach_of(start) != 1)) continue;
    ++count;
    std::array<int, 27> stack{start};
    std::size_t depth = 1;
    seen[start] = 1;
    while (depth > 0) {
      const int from = stack[--depth];
      for (int n = 0; n < 27; ++n) {
        if (n == 13 || block[n] != kind || seen[n] || (inside && reach_of(n) == 3) || !touch(from, n, inside)) continue;
        seen[n] = 1;
        stack[depth++] = n;
      }
    }
  }
  return count;
}

}  // namespace

IndicatorField without_handles(const IndicatorField& field) {
  const Grid& grid = field.value.grid;
  struct Node {
    float value;
    std::uint32_t at;
    bool operator<(const Node& o) const { return value != o.value ? value < o.value : at > o.at; }
  };
  Mask taken(grid);
  const auto block_at = [&](int i, int j, int k) {
    Block b{};
    for (int n = 0; n < 27; ++n) {
      const auto [x, y, z] = offset_of(n);
      if (grid.contains(i + x, j + y, k + z)) b[n] = taken(i + x, j + y, k + z);
    }
    return b;
  };
  std::priority_queue<Node> next;
  const auto& values = field.value.values;
  const std::uint32_t seed = std::max_element(values.begin(), values.end()) - values.begin();
  next.push({values[seed], seed});
  bool is_seed = true;
  while (!next.empty()) {
    const std::uint32_t at = next.top().at;
    next.pop();
    if (taken.values[at]) continue;
    const auto [i, j, k] = voxel_in(grid.dims, at);
    const Block block = block_at(i, j, k);
    // A node refused now is asked again whenever a neighbour comes in.
    if (!is_seed && (groups(block, 1) != 1 || groups(block, 0) != 1)) continue;
    is_seed = false;
    taken.values[at] = 1;
    for (const int n : {4, 10, 12, 14, 16, 22}) {
      const auto [x, y, z] = offset_of(n);
      if (!grid.contains(i + x, j + y, k + z)) continue;
      const std::uint32_t there = grid.index(i + x, j + y, k + z);
      if (!taken.values[there] && values[there] > 0) next.push({values[there], there});
    }
  }
  IndicatorField ball = field;
  for (std::size_t n = 0; n < values.size(); ++n) ball.value.values[n] = taken.values[n] ? 0.3f : -0.5f;
  return ball;
}

}  // namespace dynasurf::cloud
