#include "dynasurf/show/detail/plane.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/show/detail/palette.hpp"

namespace dynasurf::show {

Cutout window_around(const Image& values, int margin) {
  const Grid& g = values.grid;
  int low_i = g.dims[0], low_j = g.dims[1], high_i = -1, high_j = -1;
  for (int k = 0; k < g.dims[2]; ++k)
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i)
        if (values(i, j, k) > 0) {
          low_i = std::min(low_i, i), high_i = std::max(high_i, i);
          low_j = std::min(low_j, j), high_j = std::max(high_j, j);
        }
  if (high_i < 0) return {0, 0, g.dims[0], g.dims[1]};
  const int i = std::max(0, low_i - margin), j = std::max(0, low_j - margin);
  return {i, j, std::min(g.dims[0] - 1, high_i + margin) - i + 1, std::min(g.dims[1] - 1, high_j + margin) - j + 1};
}

SliceMap map_of(const Grid& grid, const Cutout& window, const Panel& box) {
  const double width = window.columns * grid.spacing[0], height = window.rows * grid.spacing[1];
  // One scale for both axes: voxels keep the shape that their spacing gives them.
  const double scale = std::min(box.width / width, box.height / height);
  SliceMap map{window, {box.x, box.y, width * scale, height * scale}, grid.spacing[0] * scale, grid.spacing[1] * scale};
  map.box.x += (box.width - map.box.width) / 2;
  map.box.y += (box.height - map.box.height) / 2;
  return map;
}

void draw_slice(Canvas& canvas, const SliceMap& map, const Image& image, int k, double most) {
  const Cutout& w = map.window;
  io::Picture picture(w.columns, w.rows);
  for (int j = 0; j < w.rows; ++j)
    for (int i = 0; i < w.columns; ++i) picture(i, j) = grey(most > 0 ? image.clamped(w.i + i, w.j + j, k) / most : 0);
  canvas.raster(picture, map.box);
}

double longest_in(const field::VectorField& field, const Cutout& w, int k) {
  double most = 0;
  for (int j = w.j; j < w.j + w.rows; ++j)
    for (int i = w.i; i < w.i + w.columns; ++i) {
      const std::size_t n = field.grid.index(i, j, k);
      // The part across the slice does not count: arrows do not show it either.
      most = std::max(most, own::hypot(field.x[n], field.y[n]));
    }
  return std::max(most, 1e-12);
}

void draw_vectors(Canvas& canvas, const SliceMap& map, const field::VectorField& field, int k, double longest) {
  const Cutout& w = map.window;
  canvas.rectangle(map.box, {250, 250, 250});
  canvas.clip(map.box);
  for (int j = w.j; j < w.j + w.rows; ++j)
    for (int i = w.i; i < w.i + w.columns; ++i) {
      const std::size_t n = field.grid.index(i, j, k);
      const Vec2 v(field.x[n], field.y[n]);
      const double length = v.norm();
      if (length < 1e-3 * longest) continue;
      // All arrows are nine tenths of a pixel long, so that neighbours never meet; the colour tells the length.
      const Vec2 half = 0.45 * std::min(map.column, map.row) / length * v;
      const Vec2 at = map.at(i, j);
      canvas.arrow(at - half, at + half, {viridis(length / longest), 0.9});
    }
  canvas.unclip();
  canvas.frame(map.box, {ink_of::text, 0.6});
}

}  // namespace dynasurf::show
