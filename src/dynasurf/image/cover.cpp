#include "dynasurf/image/detail/cover.hpp"

namespace dynasurf::image {

Mask cover_disc(const Mask& solid, double radius_mm) {
  const Grid& g = solid.grid;
  Mask disc(g);
  for (int k = g.dims[2] - 1; k >= 0; --k) {
    double n = 0, x = 0, y = 0;
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i)
        if (solid(i, j, k) != 0) n += 1, x += i * g.spacing[0], y += j * g.spacing[1];
    if (n == 0) continue;
    if (k + 1 == g.dims[2]) return disc;
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i) {
        const double dx = i * g.spacing[0] - x / n, dy = j * g.spacing[1] - y / n;
        disc(i, j, k + 1) = dx * dx + dy * dy <= radius_mm * radius_mm;
      }
    return disc;
  }
  return disc;
}

Mask unite(Mask a, const Mask& b) {
  for (std::size_t v = 0; v < a.values.size(); ++v) a.values[v] |= b.values[v];
  return a;
}

}  // namespace dynasurf::image
