#include "dynasurf/mesh/detail/fill_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf::mesh {
namespace {

struct Crossing {
  double x, z;
};

/// Where edge (a, b) crosses the plane at height y. Both triangles of an edge must get the same numbers, so the ends
/// are taken in the order of their indices.
Crossing cross(const TriMesh& mesh, std::uint32_t a, std::uint32_t b, double y) {
  if (a > b) std::swap(a, b);
  const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b];
  const double t = (y - p[1]) / (q[1] - p[1]);
  return {p[0] + t * (q[0] - p[0]), p[2] + t * (q[2] - p[2])};
}

/// Columns along k, `per[0]` x `per[1]` for each voxel, with the heights at which the mesh crosses them.
struct Columns {
  const Grid& grid;
  int per_x, per_y, nx, ny;
  double step_x, step_y;
  std::vector<std::vector<double>> heights;

  Columns(const Grid& g, const Index3& per)
      : grid(g),
        per_x(per[0]),
        per_y(per[1]),
        nx(g.dims[0] * per[0]),
        ny(g.dims[1] * per[1]),
        step_x(g.spacing[0] / per[0]),
        step_y(g.spacing[1] / per[1]),
        heights(size_of({nx, ny, 1})) {}

  std::size_t at(int f, int g) const { return index_in({nx, ny, 1}, {f, g, 0}); }
  double x_of(int f) const { return (f + 0.5) * step_x - grid.spacing[0] / 2; }
  double y_of(int g) const { return (g + 0.5) * step_y - grid.spacing[1] / 2; }
  /// First column at or beyond x, within the grid.
  int first_x(double x) const {
    int f = std::clamp<double>((x + grid.spacing[0] / 2) / step_x - 1.5, 0, nx);
    while (f < nx && x_of(f) < x) ++f;
    return f;
  }
  int first_y(double y) const {
    int g = std::clamp<double>((y + grid.spacing[1] / 2) / step_y - 1.5, 0, ny);
    while (g < ny && y_of(g) < y) ++g;
    return g;
  }
};

/// Half-open comparisons (low <= value < high) make every column cross a closed mesh an even number of times, also
/// when it runs through an edge or a vertex.
void add_triangle(Columns& columns, const TriMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const double y[3] = {mesh.vertices[t[0]][1], mesh.vertices[t[1]][1], mesh.vertices[t[2]][1]};
  const double low = std::min({y[0], y[1], y[2]}), high = std::max({y[0], y[1], y[2]});
  for (int g = columns.first_y(low); g < columns.ny && columns.y_of(g) < high; ++g) {
    const double line = columns.y_of(g);
    Crossing ends[2];
    int found = 0;
    for (int e = 0; e < 3 && found < 2; ++e) {
      const int n = (e + 1) % 3;
      if ((y[e] <= line) != (y[n] <= line)) ends[found++] = cross(mesh, t[e], t[n], line);
    }
    if (found < 2) continue;
    if (ends[0].x > ends[1].x) std::swap(ends[0], ends[1]);
    const double width = ends[1].x - ends[0].x;
    for (int f = columns.first_x(ends[0].x); f < columns.nx && columns.x_of(f) < ends[1].x; ++f) {
      const double s = (columns.x_of(f) - ends[0].x) / width;
      columns.heights[columns.at(f, g)].push_back(ends[0].z + s * (ends[1].z - ends[0].z));
    }
  }
}

/// Adds the part of each voxel of column (i, j) between two heights.
void add_span(std::vector<double>& parts, const Grid& grid, int i, int j, double low, double high, double weight) {
  const double dz = grid.spacing[2], top = (grid.dims[2] - 0.5) * dz;
  low = std::clamp(low, -dz / 2, top);
  high = std::clamp(high, -dz / 2, top);
  for (int k = whole_within((low + dz / 2) / dz, grid.dims[2]); k < grid.dims[2] && (k - 0.5) * dz < high; ++k) {
    const double overlap = std::min(high, (k + 0.5) * dz) - std::max(low, (k - 0.5) * dz);
    if (overlap > 0) parts[grid.index(i, j, k)] += weight * overlap / dz;
  }
}

}  // namespace

Image fill_mesh(const Grid& grid, const TriMesh& mesh, const Index3& sub_samples) {
  Columns columns(grid, sub_samples);
  for (const auto& t : mesh.triangles) add_triangle(columns, mesh, t);

  std::vector<double> parts(grid.size(), 0.0);
  const double weight = 1.0 / (1.0 * columns.per_x * columns.per_y);
  for (int g = 0; g < columns.ny; ++g)
    for (int f = 0; f < columns.nx; ++f) {
      auto& heights = columns.heights[columns.at(f, g)];
      if (heights.size() % 2 != 0) throw InputError("fill_mesh: the mesh is not closed; expected a closed surface");
      std::sort(heights.begin(), heights.end());
      for (std::size_t n = 0; n + 1 < heights.size(); n += 2)
        add_span(parts, grid, f / columns.per_x, g / columns.per_y, heights[n], heights[n + 1], weight);
    }
  Image image(grid);
  for (std::size_t v = 0; v < parts.size(); ++v) image.values[v] = std::min(1.0, parts[v]);
  return image;
}

}  // namespace dynasurf::mesh
