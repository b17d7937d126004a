// How bent a surface is at each vertex, told by its edges alone (thesis 5.5.3, eqs 5.1 and 5.2): the neighbours are put
// in order around the vertex, and the angles between them are added up. For points joined by edges whose triangles are
// not at hand. usage: example_edge_order
#include "dynasurf/mesh/edge_order.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <set>
#include <vector>

#include "dynasurf/mesh/smooth.hpp"
#include "dynasurf/synthetic/terrain.hpp"

namespace {

using namespace dynasurf;

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

}  // namespace

int main() {
  const synthetic::Terrain options;
  const TriMesh terrain = synthetic::make_terrain(options);
  std::vector<std::set<std::uint32_t>> edges(terrain.vertices.size());
  for (const auto& t : terrain.triangles)
    for (std::size_t c = 0; c < 3; ++c) edges[t[c]].insert({t[(c + 1) % 3], t[(c + 2) % 3]});

  const std::vector<double> by_triangles = mesh::angle_deficits(terrain);
  const int row = options.cells + 1;
  double largest_difference = 0;
  int inner = 0, peaks = 0;
  for (int v = 0; v < static_cast<int>(terrain.vertices.size()); ++v) {
    if (v % row == 0 || v % row == options.cells || v / row == 0 || v / row == options.cells) continue;
    const auto at = static_cast<std::size_t>(v);
    std::vector<Vec3> around;
    for (const std::uint32_t n : edges[at]) around.push_back(terrain.vertices[n]);
    const std::vector<std::uint32_t> order = mesh::order_around(terrain.vertices[at], Vec3::UnitZ(), around);
    double sum = 0;
    for (std::size_t n = 0; n < order.size(); ++n)
      sum += angle_between(around[order[n]] - terrain.vertices[at],
                           around[order[(n + 1) % order.size()]] - terrain.vertices[at]);
    const double deficit = 2 * std::numbers::pi - sum;
    largest_difference = std::max(largest_difference, std::abs(deficit - by_triangles[at]));
    ++inner;
    peaks += std::abs(deficit) > mesh::Smoothing{}.tolerance_rad ? 1 : 0;
  }
  std::printf("%d vertices inside the rim, %d of them peaks; from the triangles the same but for %.1e rad\n", inner,
              peaks, largest_difference);
  return peaks > 50 && largest_difference < 1e-12 ? 0 : 1;
}
