#include "dynasurf/report/detail/splash.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dynasurf/core/contour.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/mesh/measures.hpp"

namespace dynasurf::report {
namespace {

constexpr io::Colour background{30, 30, 30}, orange{255, 130, 0}, blue{60, 110, 255};
constexpr int slices_across = 8, cell_pixels = 110;
constexpr int gap = 4, room_above = 16;  // web/src/cohort/thumbs.ts knows them

/// The part of the slices that is shown, px, and which slices.
struct Shown {
  int i = 0, j = 0, width = 0, height = 0;
  int bottom = 0, top = 0;
  float black = 0, white = 0;
};

/// Black and white for all but the few darkest and brightest voxels: the rest of an image may hold air and bone.
void set_greys(Shown& shown, const Image& image) {
  std::vector<float> values;
  for (int k = shown.bottom; k <= std::max(shown.bottom, shown.top); ++k)
    for (int j = shown.j; j < shown.j + shown.height; ++j)
      for (int i = shown.i; i < shown.i + shown.width; ++i)
        if (image.grid.contains(i, j, k)) values.push_back(image(i, j, k));
  if (values.empty()) return;
  std::sort(values.begin(), values.end());
  const double last = values.size() - 1;
  const std::size_t black = 0.01 * last, white = 0.99 * last;
  shown.black = values[black];
  shown.white = values[white];
}

/// The slices that a surface (grid frame) meets and a window around it.
Shown around(const Image& image, const TriMesh& mesh) {
  constexpr double margin = 0.2;  // of the surface's width
  Vec3 low = mesh.vertices.front(), high = low;
  for (const Vec3& p : mesh.vertices) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const Vec3 room(margin * (high[0] - low[0]), margin * (high[1] - low[1]), 0);
  const Vec3 first = (low - room).cwiseQuotient(image.grid.spacing),
             last = (high + room).cwiseQuotient(image.grid.spacing);
  const auto pixel = [&](double at, int axis) { return std::clamp(round_int(at), 0, image.grid.dims[axis] - 1); };
  Shown shown{pixel(first[0], 0), pixel(first[1], 1)};
  shown.width = pixel(last[0], 0) - shown.i + 1;
  shown.height = pixel(last[1], 1) - shown.j + 1;
  shown.bottom = pixel(std::ceil(first[2]), 2), shown.top = pixel(std::floor(last[2]), 2);
  set_greys(shown, image);
  return shown;
}

/// One slice in the picture, its upper left corner at (left, top).
struct Cell {
  io::Picture& picture;
  const Shown& shown;
  int left, top, scale;

  void paint(const Image& image, int k) {
    const float range = shown.white - shown.black;
    for (int y = 0; y < shown.height * scale; ++y)
      for (int x = 0; x < shown.width * scale; ++x) {
        const int i = shown.i + x / scale, j = shown.j + y / scale;
        const float value = image.grid.contains(i, j, k) ? image(i, j, k) : shown.black;
        // The eye tells dark greys apart less well than bright ones; the square root lifts them.
        const double lifted = range > 0 ? std::sqrt(std::clamp((value - shown.black) / range, 0.0F, 1.0F)) : 0;
        const std::uint8_t v = 235 * lifted;
        picture(left + x, top + y) = {v, v, v};
      }
  }
  void dot(const Vec2& at, io::Colour colour) {
    const int x = floor_int((at[0] - shown.i + 0.5) * scale), y = floor_int((at[1] - shown.j + 0.5) * scale);
    if (x >= 0 && y >= 0 && x < shown.width * scale && y < shown.height * scale) picture(left + x, top + y) = colour;
  }
  /// A surface (grid frame) where slice k cuts it.
  void cut(const TriMesh& mesh, int k, const Vec3& spacing, io::Colour colour) {
    for (const auto& polygon : mesh::cross_section(mesh, Vec3(0, 0, k * spacing[2]), Vec3(0, 0, 1)))
      for (std::size_t n = 1; n < polygon.size(); ++n) {
        const Vec2 from(polygon[n - 1][0] / spacing[0], polygon[n - 1][1] / spacing[1]),
            to(polygon[n][0] / spacing[0], polygon[n][1] / spacing[1]);
        const int steps = 1 + own::hypot(to[0] - from[0], to[1] - from[1]) * scale * 1.5;
        for (int s = 0; s <= steps; ++s) dot(from + (to - from) * s / steps, colour);
      }
  }
};

}  // namespace

io::Picture draw_splash(const std::vector<SplashRow>& rows) {
  const Image& first = *rows.front().image;
  const Shown shown = around(first, to_grid(first.grid, rows.front().epi ? *rows.front().epi : *rows.front().endo));
  const int scale = std::max(1, cell_pixels / std::max(shown.width, shown.height));
  const int width = shown.width * scale + gap, height = shown.height * scale + room_above + gap;
  io::Picture picture(slices_across * width + gap, rows.size() * height + gap, background);
  // At most 36 slices are told apart, evenly spaced.
  constexpr int most_slices = 36;
  const int stride = 1 + (shown.top - shown.bottom) / most_slices;
  const int last = std::max(0, (shown.top - shown.bottom) / stride);
  for (int r = 0; r < std::ssize(rows); ++r)
    for (int c = 0; c < slices_across; ++c) {
      const SplashRow& row = rows[r];
      const int k = shown.bottom + stride * (c * last / (slices_across - 1));
      Cell cell{picture, shown, gap + c * width, gap + r * height + room_above, scale};
      cell.paint(*row.image, k);
      for (const auto& [wall, colour] : {std::pair(row.epi, orange), std::pair(row.endo, blue)})
        if (wall) cell.cut(to_grid(first.grid, *wall), k, first.grid.spacing, colour);
    }
  return picture;
}

}  // namespace dynasurf::report
