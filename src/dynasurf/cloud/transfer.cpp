#include "dynasurf/cloud/transfer.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/cloud/light.hpp"
#include "dynasurf/cloud/neighbours.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/closest_point.hpp"

namespace dynasurf {
namespace {

constexpr std::size_t grain = 1024, most_points_per_vertex = 64;

}  // namespace

std::vector<std::array<std::uint8_t, 3>> colours_at_vertices(const TriMesh& mesh, const PointCloud& cloud) {
  std::vector<std::array<std::uint8_t, 3>> colours;
  if (cloud.colours.empty() || mesh.vertices.empty()) return colours;
  colours.resize(mesh.vertices.size());
  const std::array<double, 256> linear = linear_light();
  const std::size_t near =
      std::clamp<std::size_t>(cloud.points.size() / mesh.vertices.size(), 1, most_points_per_vertex);
  const Neighbours neighbours(cloud.points);
  parallel_for(mesh.vertices.size(), grain, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbours::Found> found(near);
    for (std::size_t v = begin; v < end; ++v) {
      const std::size_t count = neighbours.nearest(mesh.vertices[v], found);
      for (std::size_t c = 0; c < 3; ++c) {
        double light = 0;
        for (std::size_t n = 0; n < count; ++n) light += linear[cloud.colours[found[n].index][c]];
        colours[v][c] = srgb_byte(light / static_cast<double>(count));
      }
    }
  });
  return colours;
}

std::vector<float> errors_at_vertices(const TriMesh& mesh, const PointCloud& cloud) {
  std::vector<SurfacePoint> nearest(cloud.points.size());
  if (mesh.triangles.empty()) return std::vector<float>(mesh.vertices.size(), -1);
  const ClosestPoint closest(mesh);
  parallel_for(nearest.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) nearest[n] = closest(cloud.points[n]);
  });
  // Gathered in the order of the points, so that the sums are the same for any number of threads.
  std::vector<double> sum(mesh.vertices.size(), 0), weight(mesh.vertices.size(), 0);
  for (const SurfacePoint& p : nearest)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t v = mesh.triangles[p.triangle][corner];
      sum[v] += p.weights[corner] * std::sqrt(p.distance2);
      weight[v] += p.weights[corner];
    }
  std::vector<float> errors(mesh.vertices.size(), -1);
  for (std::size_t v = 0; v < errors.size(); ++v)
    if (weight[v] > 1e-9) errors[v] = static_cast<float>(sum[v] / weight[v]);
  return errors;
}

}  // namespace dynasurf
