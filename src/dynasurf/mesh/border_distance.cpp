#include "dynasurf/mesh/detail/border_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/visit_marked.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::mesh {
namespace {

/// Voxel nearest to a coordinate given in voxels, inside the grid.
int nearest_index(double x, int count) { return whole_within(x + 0.5, count); }

double square(double x) { return x * x; }

template <class Distance>
std::vector<double> for_all_vertices(const TriMesh& mesh, Distance&& distance) {
  std::vector<double> result(mesh.vertices.size());
  parallel_for(result.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) result[v] = distance(mesh.vertices[v]);
  });
  return result;
}

}  // namespace

BorderDistance::BorderDistance(const Image& border)
    : grid_(border.grid), row_begin_(size_of({1, grid_.dims[1], grid_.dims[2]}) + 1, 0) {
  for (int k = 0; k < grid_.dims[2]; ++k)
    visit_marked(border, k, [&](int i, int j) {
      columns_.push_back(i);
      ++row_begin_[row_of(j, k) + 1];
    });
  std::partial_sum(row_begin_.begin(), row_begin_.end(), row_begin_.begin());
}

// Rows of voxels are visited in square rings around the row of the point. A row in ring r is at least r - 1/2 voxels
// away, so the search ends once that is farther than the best voxel found.
double BorderDistance::distance(const Vec3& p, const Vec3& scale, double limit) const {
  if (columns_.empty() || !p.allFinite()) return std::numeric_limits<double>::infinity();
  const int ci = nearest_index(p[0], grid_.dims[0]), cj = nearest_index(p[1], grid_.dims[1]),
            ck = nearest_index(p[2], grid_.dims[2]);
  double best = std::isinf(limit) ? limit : square(limit);
  bool found = false;
  const auto try_row = [&](int j, int k) {
    if (j < 0 || k < 0 || j >= grid_.dims[1] || k >= grid_.dims[2]) return;
    const double across = square(scale[1] * (p[1] - j)) + square(scale[2] * (p[2] - k));
    if (across > best) return;
    const auto try_voxel = [&](int i) {
      const double d = across + square(scale[0] * (p[0] - i));
      if (d > best) return;
      best = d;
      found = true;
    };
    // The nearest of a row are the last one before column ci and the first one from it on.
    const std::size_t row = row_of(j, k);
    const auto begin = columns_.begin() + row_begin_[row], end = columns_.begin() + row_begin_[row + 1];
    const auto after = std::lower_bound(begin, end, ci);
    if (after != begin) try_voxel(*(after - 1));
    if (after != end) try_voxel(*after);
  };

  try_row(cj, ck);
  const double ring_width = std::min(scale[1], scale[2]);
  const int last_ring = std::max(std::max(cj, grid_.dims[1] - 1 - cj), std::max(ck, grid_.dims[2] - 1 - ck));
  for (int r = 1; r <= last_ring && square((r - 0.5) * ring_width) <= best; ++r) {
    for (int j = cj - r; j <= cj + r; ++j) try_row(j, ck - r), try_row(j, ck + r);
    for (int k = ck - r + 1; k < ck + r; ++k) try_row(cj - r, k), try_row(cj + r, k);
  }
  return found ? std::sqrt(best) : std::numeric_limits<double>::infinity();
}

std::vector<double> signed_distances_to_border_voxels(const TriMesh& mesh, const Image& border) {
  const Image solid = enclosed_solid(border);
  std::vector<double> distances = distances_to_border_voxels(mesh, border);
  for (std::size_t v = 0; v < distances.size(); ++v) {
    const Vec3 at = mesh.vertices[v].cwiseQuotient(border.grid.spacing);
    bool inside = true;
    Index3 voxel{};
    for (int a = 0; a < 3 && inside; ++a) {
      inside = at[a] > -0.5 && at[a] < border.grid.dims[a] - 0.5;
      if (inside) voxel[a] = round_int(at[a]);
    }
    if (inside && solid(voxel[0], voxel[1], voxel[2]) != 0) distances[v] = -distances[v];
  }
  return distances;
}

double share_of_border_reached(const TriMesh& mesh, const Image& border, double reach_voxels) {
  const Grid& g = border.grid;
  const auto inside = [&](double at, int a) { return whole_within(at, g.dims[a]); };
  std::vector<std::uint8_t> reached(border.values.size(), 0);
  const double reach2 = square(reach_voxels);
  for (const auto& t : mesh.triangles) {
    std::array<Vec3, 3> corner;  // in voxels
    for (std::size_t c = 0; c < 3; ++c) corner[c] = mesh.vertices[t[c]].cwiseQuotient(g.spacing);
    const Vec3 least = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]).array() - reach_voxels;
    const Vec3 most = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]).array() + reach_voxels;
    bool is_near = true;
    Index3 low, high;
    for (int a = 0; a < 3; ++a) {
      is_near = is_near && most[a] > 0 && least[a] < g.dims[a] - 1;
      low[a] = inside(std::ceil(least[a]), a), high[a] = inside(std::floor(most[a]), a);
    }
    if (!is_near) continue;
    for (int k = low[2]; k <= high[2]; ++k)
      for (int j = low[1]; j <= high[1]; ++j)
        for (int i = low[0]; i <= high[0]; ++i) {
          const std::size_t at = g.index(i, j, k);
          if (border.values[at] == 0 || reached[at] != 0) continue;
          if (closest_on_triangle(Vec3(i, j, k), corner[0], corner[1], corner[2]).distance2 < reach2) reached[at] = 1;
        }
  }
  std::size_t all = 0, near = 0;
  for (int k = 0; k < g.dims[2]; ++k)
    visit_marked(border, k, [&](int i, int j) { ++all, near += reached[g.index(i, j, k)]; });
  return all > 0 ? 1.0 * near / all : 1;
}

std::vector<double> distances_to_border_voxels(const TriMesh& mesh, const Image& border) {
  const BorderDistance to_border(border);
  return for_all_vertices(mesh, [&](const Vec3& p) { return to_border.voxels(p); });
}

std::vector<double> distances_to_border_mm(const TriMesh& mesh, const Image& border) {
  const BorderDistance to_border(border);
  return for_all_vertices(mesh, [&](const Vec3& p) { return to_border.mm(p); });
}

}  // namespace dynasurf::mesh
