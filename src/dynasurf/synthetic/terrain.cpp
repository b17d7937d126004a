#include "dynasurf/synthetic/terrain.hpp"

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::synthetic {

double hill_height_mm(const Terrain& o, double x_mm, double y_mm) {
  return o.hill_mm * own::sin(x_mm / (7 * o.cell_mm)) * own::cos(y_mm / (9 * o.cell_mm));
}

TriMesh make_terrain(const Terrain& options) {
  Terrain o = options;
  check_options(o, "terrain");
  const auto is_spike = [&](int i, int j) {
    const bool inner = i % o.cells != 0 && j % o.cells != 0;
    return inner && o.spike_every > 0 && (7 * i + 13 * j) % o.spike_every == 0;
  };
  TriMesh mesh;
  for (int j = 0; j <= o.cells; ++j)
    for (int i = 0; i <= o.cells; ++i) {
      const double x = i * o.cell_mm, y = j * o.cell_mm;
      mesh.vertices.emplace_back(x, y, hill_height_mm(o, x, y) + (is_spike(i, j) ? o.spike_mm : 0));
    }
  const auto vertex = [&](int i, int j) -> std::uint32_t { return j * (o.cells + 1) + i; };
  for (int j = 0; j < o.cells; ++j)
    for (int i = 0; i < o.cells; ++i) {
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  return mesh;
}

}  // namespace dynasurf::synthetic
