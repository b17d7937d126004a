#include "sheets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "dynasurf/ventricle/labels/mlc.hpp"
#include "dynasurf/ventricle/labels/radial.hpp"

namespace dynasurf::app {
namespace {

constexpr Colour white{255, 255, 255}, grey{90, 90, 90}, yellow{255, 220, 0}, orange{255, 130, 0}, red{255, 40, 40},
    blue{60, 110, 255}, violet{220, 60, 220}, green{0, 230, 90}, dim_yellow{120, 110, 30}, dim_red{130, 20, 20},
    dim_blue{30, 55, 130};
constexpr int gap = 4, tile_pixels = 192;

/// Digits of 3 x 5 pixels, a row per three bits from the top.
constexpr std::array<int, 10> digits{075557, 026227, 071747, 071717, 055711, 074717, 074757, 071111, 075757, 075717};

void draw_number(Picture& p, int number, int x, int y, Colour colour) {
  for (const char c : std::to_string(number)) {
    const int bits = digits[static_cast<std::size_t>(c - '0')];
    for (int n = 0; n < 15; ++n)
      if (bits >> (14 - n) & 1)
        for (int a = 0; a < 4; ++a) p(x + n % 3 * 2 + a % 2, y + n / 3 * 2 + a / 2) = colour;
    x += 8;
  }
}

/// One slice, magnified, somewhere in a picture. Positions are those of the slice: (0, 0) is the centre of its first
/// pixel.
class Tile {
 public:
  Tile(Picture& picture, int left, int top, int scale, int width, int height)
      : picture_(picture), left_(left), top_(top), scale_(scale), width_(width), height_(height) {}

  void paint(int i, int j, Colour colour) {
    for (int y = 0; y < scale_; ++y)
      for (int x = 0; x < scale_; ++x) picture_(left_ + i * scale_ + x, top_ + j * scale_ + y) = colour;
  }
  void dot(double i, double j, Colour colour) {
    const int x = static_cast<int>(std::floor((i + 0.5) * scale_)),
              y = static_cast<int>(std::floor((j + 0.5) * scale_));
    if (x >= 0 && y >= 0 && x < width_ * scale_ && y < height_ * scale_) picture_(left_ + x, top_ + y) = colour;
  }
  void line(double i0, double j0, double i1, double j1, Colour colour) {
    const int steps = 1 + static_cast<int>(std::hypot(i1 - i0, j1 - j0) * scale_ * 1.5);
    for (int n = 0; n <= steps; ++n) dot(i0 + (i1 - i0) * n / steps, j0 + (j1 - j0) * n / steps, colour);
  }
  void circle(double i, double j, double radius, Colour colour) {
    const int steps = 8 + static_cast<int>(radius * scale_ * 8);
    for (int n = 0; n < steps; ++n) {
      const double a = 2 * std::numbers::pi * n / steps;
      dot(i + radius * std::cos(a), j + radius * std::sin(a), colour);
    }
  }
  void cross(double i, double j, double arm, Colour colour) {
    line(i - arm, j, i + arm, j, colour);
    line(i, j - arm, i, j + arm, colour);
  }
  void box(double i0, double j0, double i1, double j1, Colour colour) {
    line(i0, j0, i1, j0, colour), line(i1, j0, i1, j1, colour), line(i1, j1, i0, j1, colour),
        line(i0, j1, i0, j0, colour);
  }
  void number(int n) { draw_number(picture_, n, left_ + 3, top_ + 3, white); }
  void frame(Colour colour) {
    const double right = width_ - 1, bottom = height_ - 1;
    box(-0.45, -0.45, right + 0.45, bottom + 0.45, colour);
  }

 private:
  Picture& picture_;
  int left_, top_, scale_, width_, height_;
};

std::uint8_t shade(float value, float max) {
  // The eye tells dark greys apart less well than bright ones; the square root lifts them.
  return static_cast<std::uint8_t>(max > 0 ? 235 * std::sqrt(std::clamp(value / max, 0.0F, 1.0F)) : 0);
}

/// A sheet with a place for every slice; `extra` pixels are left free to the right of each.
Picture draw_sheet(const Image& image, int extra,
                   const std::function<void(Picture&, Tile&, int k, int x, int y)>& draw) {
  const auto [nx, ny, nz] = image.grid.dims;
  const int scale = std::max(1, tile_pixels / std::max(nx, ny));
  const int width = nx * scale + extra + gap, height = ny * scale + gap;
  const int columns = std::max(1, static_cast<int>(std::ceil(std::sqrt(nz * 1.5 * height / width))));
  const int rows = (nz + columns - 1) / columns;
  Picture picture(columns * width + gap, std::max(1, rows) * height + gap, {30, 30, 30});
  const float max = image.values.empty() ? 0 : *std::max_element(image.values.begin(), image.values.end());
  for (int k = 0; k < nz; ++k) {
    const int left = gap + k % columns * width, top = gap + k / columns * height;
    Tile tile(picture, left, top, scale, nx, ny);
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const std::uint8_t v = shade(image(i, j, k), max);
        tile.paint(i, j, {v, v, v});
      }
    draw(picture, tile, k, left + nx * scale, top);
    tile.number(k + 1);
  }
  return picture;
}

void draw_box(Tile& tile, const std::vector<Pixel>& pixels, Colour colour) {
  if (pixels.empty()) return;
  const auto [i0, i1] = std::minmax_element(pixels.begin(), pixels.end(), [](auto a, auto b) { return a.i < b.i; });
  const auto [j0, j1] = std::minmax_element(pixels.begin(), pixels.end(), [](auto a, auto b) { return a.j < b.j; });
  tile.box(i0->i - 0.45, j0->j - 0.45, i1->i + 0.45, j1->j + 0.45, colour);
}

/// Bars of the counts of a slice, bottom up, in a strip of the picture.
void draw_bars(Picture& p, const RadialProfile& profile, double ring_px, int x0, int y0, int width, int height,
               double reach_px) {
  const int most = profile.counts.empty() ? 0 : *std::max_element(profile.counts.begin(), profile.counts.end());
  for (int x = 0; x < width; ++x) {
    p(x0 + x, y0 + height - 1) = grey;
    const double radius = x * reach_px / width;
    const auto ring = static_cast<std::size_t>(radius / ring_px);
    if (most == 0 || ring >= profile.counts.size()) continue;
    const bool peak = std::any_of(profile.peaks_px.begin(), profile.peaks_px.end(),
                                  [&](double r) { return static_cast<std::size_t>(r / ring_px) == ring; });
    const int bar = profile.counts[ring] * (height - 2) / most;
    for (int y = 0; y < bar; ++y) p(x0 + x, y0 + height - 2 - y) = peak ? red : white;
  }
}

}  // namespace

Picture draw_edges(const Image& image, const EdgeMap& edges) {
  return draw_sheet(image, 0, [&](Picture&, Tile& tile, int k, int, int) {
    for (int j = 0; j < image.grid.dims[1]; ++j)
      for (int i = 0; i < image.grid.dims[0]; ++i)
        if (const int edge = edges.edges(i, j, k)) tile.paint(i, j, edge == 1 ? orange : yellow);
  });
}

Picture draw_labels(const Image& image, const GateBorders& gate, const Circle& coarse) {
  const Labels& labels = gate.labels;
  return draw_sheet(image, 0, [&](Picture&, Tile& tile, int k, int, int) {
    for (int j = 0; j < image.grid.dims[1]; ++j)
      for (int i = 0; i < image.grid.dims[0]; ++i) {
        const int bits = labels.borders(i, j, k);
        if (bits)
          tile.paint(i, j, bits == Labels::endo_bit ? blue : bits == Labels::epi_bit ? red : violet);
        else if (gate.edges.edges(i, j, k))
          tile.paint(i, j, yellow);
      }
    draw_box(tile, pixels_of(labels.borders, k, Labels::epi_bit), dim_red);
    draw_box(tile, pixels_of(labels.borders, k, Labels::endo_bit), dim_blue);
    tile.circle(coarse.x_px, coarse.y_px, coarse.radius_px, dim_yellow);
    tile.circle(labels.axis.x_at(k), labels.axis.y_at(k), labels.circle.radius_px, white);
    if (const auto& local = labels.local[static_cast<std::size_t>(k)]) tile.cross(local->x_px, local->y_px, 1, green);
    tile.cross(labels.axis.x_at(k), labels.axis.y_at(k), 1, red);
    if (k == labels.division_slice) tile.frame(white);
  });
}

Picture draw_rings(const Image& image, const GateBorders& gate, const RadialLabels& options) {
  constexpr int graph_width = 96;
  const Labels& labels = gate.labels;
  const SliceEdges edges = find_components(clip(gate.edges.edges, labels.axis, labels.circle.radius_px), 1);
  return draw_sheet(image, graph_width, [&](Picture& picture, Tile& tile, int k, int x, int y) {
    const auto& slice = edges[static_cast<std::size_t>(k)];
    for (const Component& edge : slice)
      for (const Pixel& p : edge.pixels) tile.paint(p.i, p.j, yellow);
    RadialLabels o = options;
    for (const double radius : radial_profile(slice, labels.axis, labels.circle.radius_px, o).peaks_px)
      tile.circle(labels.axis.x_at(k), labels.axis.y_at(k), radius, red);
    tile.circle(labels.axis.x_at(k), labels.axis.y_at(k), labels.circle.radius_px, white);
    const int scale = std::max(1, tile_pixels / std::max(image.grid.dims[0], image.grid.dims[1]));
    const int height = image.grid.dims[1] * scale / 3;
    for (int n = 0; n < 3; ++n) {
      o.ring_px = n + 1;
      draw_bars(picture, radial_profile(slice, labels.axis, labels.circle.radius_px, o), o.ring_px, x + 4,
                y + n * height, graph_width - 8, height, labels.circle.radius_px);
    }
  });
}

}  // namespace dynasurf::app
