#include "dynasurf/cloud/detail/transfer.hpp"

#include <algorithm>

#include "dynasurf/cloud/detail/light.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::cloud {
namespace {

constexpr std::size_t transfer_grain = 1024, most_points_per_vertex = 64;

}  // namespace

std::vector<std::array<std::uint8_t, 3>> colours_at_vertices(const TriMesh& mesh, const PointCloud& cloud,
                                                             const KdTree& neighbours) {
  std::vector<std::array<std::uint8_t, 3>> colours;
  if (cloud.colours.empty() || mesh.vertices.empty()) return colours;
  colours.resize(mesh.vertices.size());
  const std::array<double, 256> linear = linear_light();
  const std::size_t near =
      std::clamp<std::size_t>(cloud.points.size() / mesh.vertices.size(), 1, most_points_per_vertex);
  parallel_for(mesh.vertices.size(), transfer_grain, [&](std::size_t begin, std::size_t end) {
    std::vector<KdTree::Found> found(near);
    for (std::size_t v = begin; v < end; ++v) {
      const std::size_t count = neighbours.nearest(mesh.vertices[v], found);
      for (std::size_t c = 0; c < 3; ++c) {
        double light = 0;
        for (std::size_t n = 0; n < count; ++n) light += linear[cloud.colours[found[n].index][c]];
        colours[v][c] = srgb_byte(light / count);
      }
    }
  });
  return colours;
}

}  // namespace dynasurf::cloud
