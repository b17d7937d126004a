#include "dynasurf/report/detail/sheets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/report/detail/lettering.hpp"
#include "dynasurf/ventricle/labels/detail/mlc.hpp"
#include "dynasurf/ventricle/labels/detail/radial.hpp"

namespace dynasurf::report {
namespace {

constexpr io::Colour white{255, 255, 255}, grey{90, 90, 90}, yellow{255, 220, 0}, orange{255, 130, 0}, red{255, 40, 40},
    blue{60, 110, 255}, violet{220, 60, 220}, green{0, 230, 90}, dim_yellow{120, 110, 30}, dim_red{130, 20, 20},
    dim_blue{30, 55, 130}, light_grey{170, 170, 170}, background{30, 30, 30};
constexpr int gap = 4, tile_pixels = 192, line_height = 16;

/// The part of a slice that is shown, px.
struct Window {
  int i = 0, j = 0, width = 0, height = 0;
};

/// One slice, magnified, somewhere in a picture. Positions are those of the slice: (0, 0) is the centre of its first
/// pixel. What lies outside the window is not drawn.
class Tile {
 public:
  Tile(io::Picture& picture, int left, int top, int scale, const Window& window)
      : picture_(picture), left_(left), top_(top), scale_(scale), window_(window) {}

  void paint(int i, int j, io::Colour colour) {
    for (int n = 0; n < scale_ * scale_; ++n)
      set((i - window_.i) * scale_ + n % scale_, (j - window_.j) * scale_ + n / scale_, colour);
  }
  void dot(double i, double j, io::Colour colour) {
    set(static_cast<int>(std::floor((i - window_.i + 0.5) * scale_)),
        static_cast<int>(std::floor((j - window_.j + 0.5) * scale_)), colour);
  }
  void line(double i0, double j0, double i1, double j1, io::Colour colour) {
    const int steps = 1 + static_cast<int>(own::hypot(i1 - i0, j1 - j0) * scale_ * 1.5);
    for (int n = 0; n <= steps; ++n) dot(i0 + (i1 - i0) * n / steps, j0 + (j1 - j0) * n / steps, colour);
  }
  void circle(double i, double j, double radius, io::Colour colour) {
    const int steps = 8 + static_cast<int>(radius * scale_ * 8);
    for (int n = 0; n < steps; ++n) {
      const double a = 2 * std::numbers::pi * n / steps;
      dot(i + radius * own::cos(a), j + radius * own::sin(a), colour);
    }
  }
  void cross(double i, double j, double arm, io::Colour colour) {
    line(i - arm, j, i + arm, j, colour);
    line(i, j - arm, i, j + arm, colour);
  }
  void box(double i0, double j0, double i1, double j1, io::Colour colour) {
    line(i0, j0, i1, j0, colour), line(i1, j0, i1, j1, colour), line(i1, j1, i0, j1, colour),
        line(i0, j1, i0, j0, colour);
  }
  void text(const std::string& text) { draw_text(picture_, text, left_ + 3, top_ + 3, white); }
  void frame(io::Colour colour) {
    box(window_.i - 0.45, window_.j - 0.45, window_.i + window_.width - 0.55, window_.j + window_.height - 0.55,
        colour);
  }
  const Window& window() const { return window_; }

 private:
  void set(int x, int y, io::Colour colour) {
    if (x >= 0 && y >= 0 && x < window_.width * scale_ && y < window_.height * scale_)
      picture_(left_ + x, top_ + y) = colour;
  }
  io::Picture& picture_;
  int left_, top_, scale_;
  Window window_;
};

/// Values that are drawn black and white.
struct GreyScale {
  float black = 0, white = 0;
};

std::uint8_t shade(float value, const GreyScale& scale) {
  const float range = scale.white - scale.black;
  // The eye tells dark greys apart less well than bright ones; the square root lifts them.
  return static_cast<std::uint8_t>(range > 0 ? 235 * std::sqrt(std::clamp((value - scale.black) / range, 0.0F, 1.0F))
                                             : 0);
}

void draw_image(Tile& tile, const Image& image, int k, const GreyScale& scale) {
  const Window& w = tile.window();
  for (int j = w.j; j < w.j + w.height; ++j)
    for (int i = w.i; i < w.i + w.width; ++i) {
      const std::uint8_t v = image.grid.contains(i, j, k) ? shade(image(i, j, k), scale) : 0;
      tile.paint(i, j, {v, v, v});
    }
}

GreyScale up_to_brightest(const Image& image) {
  return {0, image.values.empty() ? 0 : *std::max_element(image.values.begin(), image.values.end())};
}

/// What a colour means.
struct Key {
  io::Colour colour;
  std::string meaning;
};
using Legend = std::vector<Key>;
const Legend edge_legend{{yellow, "major edge"}, {orange, "minor edge"}};
const Legend label_legend{{red, "outer border, its box"},      {blue, "inner border, its box"},
                          {violet, "both, or not told apart"}, {yellow, "edge left over"},
                          {dim_yellow, "coarse circle"},       {white, "automatic circle; frame: division slice"},
                          {green, "centre in the slice"},      {red, "+ axis"}};
const Legend ring_legend{{yellow, "edge inside the circle"},
                         {red, "peaks: rings with most edge pixels"},
                         {white, "automatic circle; bars: edge pixels by distance, rings of 1, 2, 3 px"}};
const Legend section_legend{{red, "the surface, cut by the slice"}};

constexpr int swatch = 10;
int width_of(const Key& key) { return swatch + 4 + static_cast<int>(key.meaning.size()) * letter_width + 14; }

/// Height of the title and of the legend in lines of `width`.
int head_height(const Legend& legend, int width) {
  int lines = 2, x = gap;
  for (const Key& key : legend) {
    if (x > gap && x + width_of(key) > width) ++lines, x = gap;
    x += width_of(key);
  }
  return lines * line_height + gap;
}

void draw_head(io::Picture& picture, const std::string& title, const Legend& legend) {
  draw_text(picture, title, gap, gap, white);
  int x = gap, y = gap + line_height;
  for (const Key& key : legend) {
    if (x > gap && x + width_of(key) > picture.width) x = gap, y += line_height;
    for (int n = 0; n < swatch * swatch; ++n) {
      const int px = x + n % swatch;
      if (px < picture.width) picture(px, y + n / swatch) = key.colour;
    }
    draw_text(picture, key.meaning, x + swatch + 4, y, light_grey);
    x += width_of(key);
  }
}

/// What of an image a sheet shows.
struct Shown {
  std::vector<int> slices;
  Window window;
  GreyScale grey;
  int extra = 0;  // pixels that are left free to the right of each slice
};

Shown all_of(const Image& image, int extra = 0) {
  Shown shown{{}, {0, 0, image.grid.dims[0], image.grid.dims[1]}, up_to_brightest(image), extra};
  for (int k = 0; k < image.grid.dims[2]; ++k) shown.slices.push_back(k);
  return shown;
}

/// A sheet with a place for every slice.
io::Picture draw_sheet(const Image& image, const Shown& shown, const std::string& title, const Legend& legend,
                       const std::function<void(io::Picture&, Tile&, int k, int x, int y)>& draw) {
  const Window& window = shown.window;
  const int count = static_cast<int>(shown.slices.size());
  const int scale = std::max(1, tile_pixels / std::max(window.width, window.height));
  const int width = window.width * scale + shown.extra + gap, height = window.height * scale + gap;
  const int columns = std::max(1, static_cast<int>(std::ceil(std::sqrt(count * 1.5 * height / width))));
  const int rows = (count + columns - 1) / columns;
  const int head = head_height(legend, columns * width + gap);
  io::Picture picture(columns * width + gap, head + std::max(1, rows) * height + gap, background);
  draw_head(picture, title, legend);
  for (int n = 0; n < count; ++n) {
    const int k = shown.slices[static_cast<std::size_t>(n)];
    const int left = gap + n % columns * width, top = head + gap + n / columns * height;
    Tile tile(picture, left, top, scale, window);
    draw_image(tile, image, k, shown.grey);
    draw(picture, tile, k, left + window.width * scale, top);
    tile.text(std::to_string(k + 1));
  }
  return picture;
}

/// Of what a window shows, black and white for all but the few darkest and brightest voxels: the rest of an image may
/// hold air and bone.
GreyScale usual_values(const Image& image, const std::vector<int>& slices, const Window& w) {
  std::vector<float> values;
  for (const int k : slices)
    for (int j = w.j; j < w.j + w.height; ++j)
      for (int i = w.i; i < w.i + w.width; ++i)
        if (image.grid.contains(i, j, k)) values.push_back(image(i, j, k));
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto last = static_cast<double>(values.size() - 1);
  return {values[static_cast<std::size_t>(0.01 * last)], values[static_cast<std::size_t>(0.99 * last)]};
}

/// The slices that a surface meets and a window around it, px; `mesh` in the grid frame.
Shown around(const Image& image, const TriMesh& mesh) {
  constexpr double margin = 0.2;  // of the surface's width
  constexpr int most_slices = 36;
  Vec3 low = mesh.vertices.front(), high = low;
  for (const Vec3& p : mesh.vertices) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const Vec3 room(margin * (high[0] - low[0]), margin * (high[1] - low[1]), 0);
  const Vec3 first = (low - room).cwiseQuotient(image.grid.spacing),
             last = (high + room).cwiseQuotient(image.grid.spacing);
  const auto pixel = [&](double at, int axis) {
    return std::clamp(static_cast<int>(std::lround(at)), 0, image.grid.dims[static_cast<std::size_t>(axis)] - 1);
  };
  Shown shown;
  shown.window = {pixel(first[0], 0), pixel(first[1], 1), 0, 0};
  shown.window.width = pixel(last[0], 0) - shown.window.i + 1;
  shown.window.height = pixel(last[1], 1) - shown.window.j + 1;
  const int bottom = pixel(std::ceil(first[2]), 2), top = pixel(std::floor(last[2]), 2);
  const int stride = 1 + (top - bottom) / most_slices;
  for (int k = bottom; k <= std::max(bottom, top); k += stride) shown.slices.push_back(k);
  shown.grey = usual_values(image, shown.slices, shown.window);
  return shown;
}

/// A surface (grid frame) where slice k cuts it.
void draw_cut(Tile& tile, const TriMesh& mesh, int k, const Vec3& spacing, io::Colour colour) {
  for (const auto& polygon : mesh::cross_section(mesh, Vec3(0, 0, k * spacing[2]), Vec3(0, 0, 1)))
    for (std::size_t n = 1; n < polygon.size(); ++n)
      tile.line(polygon[n - 1][0] / spacing[0], polygon[n - 1][1] / spacing[1], polygon[n][0] / spacing[0],
                polygon[n][1] / spacing[1], colour);
}

void draw_box(Tile& tile, const std::vector<image::Pixel>& pixels, io::Colour colour) {
  if (pixels.empty()) return;
  const auto [i0, i1] = std::minmax_element(pixels.begin(), pixels.end(), [](auto a, auto b) { return a.i < b.i; });
  const auto [j0, j1] = std::minmax_element(pixels.begin(), pixels.end(), [](auto a, auto b) { return a.j < b.j; });
  tile.box(i0->i - 0.45, j0->j - 0.45, i1->i + 0.45, j1->j + 0.45, colour);
}

/// Bars of the counts of a slice, bottom up, in a strip of the picture.
void draw_bars(io::Picture& p, const ventricle::RadialProfile& profile, double ring_px, int x0, int y0, int width,
               int height, double reach_px) {
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

void draw_edge_pixels(Tile& tile, const image::EdgeMap& edges, int k) {
  for (int j = 0; j < edges.edges.grid.dims[1]; ++j)
    for (int i = 0; i < edges.edges.grid.dims[0]; ++i)
      if (const int edge = edges.edges(i, j, k)) tile.paint(i, j, edge == 1 ? orange : yellow);
}

void draw_label_marks(Tile& tile, const ventricle::GateBorders& gate, const ventricle::Circle& coarse, int k) {
  const ventricle::Labels& labels = gate.labels;
  draw_edge_pixels(tile, gate.edges, k);
  for (int j = 0; j < labels.borders.grid.dims[1]; ++j)
    for (int i = 0; i < labels.borders.grid.dims[0]; ++i)
      if (const int bits = labels.borders(i, j, k))
        tile.paint(i, j,
                   bits == ventricle::Labels::endo_bit  ? blue
                   : bits == ventricle::Labels::epi_bit ? red
                                                        : violet);
  draw_box(tile, ventricle::pixels_of(labels.borders, k, ventricle::Labels::epi_bit), dim_red);
  draw_box(tile, ventricle::pixels_of(labels.borders, k, ventricle::Labels::endo_bit), dim_blue);
  tile.circle(coarse.x_px, coarse.y_px, coarse.radius_px, dim_yellow);
  tile.circle(labels.axis.x_at(k), labels.axis.y_at(k), labels.circle.radius_px, white);
  if (const auto& local = labels.local[static_cast<std::size_t>(k)]) tile.cross(local->x_px, local->y_px, 1, green);
  tile.cross(labels.axis.x_at(k), labels.axis.y_at(k), 1, red);
  if (k == labels.division_slice) tile.frame(white);
}

}  // namespace

io::Picture draw_edges(const Image& image, const image::EdgeMap& edges, const std::string& title) {
  return draw_sheet(image, all_of(image), title, edge_legend,
                    [&](io::Picture&, Tile& tile, int k, int, int) { draw_edge_pixels(tile, edges, k); });
}

io::Picture draw_labels(const Image& image, const ventricle::GateBorders& gate, const ventricle::Circle& coarse,
                        const std::string& title) {
  return draw_sheet(image, all_of(image), title, label_legend,
                    [&](io::Picture&, Tile& tile, int k, int, int) { draw_label_marks(tile, gate, coarse, k); });
}

io::Picture draw_rings(const Image& image, const ventricle::GateBorders& gate, const ventricle::RadialLabels& options,
                       const std::string& title) {
  constexpr int graph_width = 96;
  const ventricle::Labels& labels = gate.labels;
  const ventricle::SliceEdges edges =
      ventricle::find_components(ventricle::clip(gate.edges.edges, labels.axis, labels.circle.radius_px), 1);
  return draw_sheet(
      image, all_of(image, graph_width), title, ring_legend,
      [&](io::Picture& picture, Tile& tile, int k, int x, int y) {
        const auto& slice = edges[static_cast<std::size_t>(k)];
        for (const image::Component& edge : slice)
          for (const image::Pixel& p : edge.pixels) tile.paint(p.i, p.j, yellow);
        ventricle::RadialLabels o = options;
        for (const double radius : ventricle::radial_profile(slice, labels.axis, labels.circle.radius_px, o).peaks_px)
          tile.circle(labels.axis.x_at(k), labels.axis.y_at(k), radius, red);
        tile.circle(labels.axis.x_at(k), labels.axis.y_at(k), labels.circle.radius_px, white);
        const int scale = std::max(1, tile_pixels / std::max(image.grid.dims[0], image.grid.dims[1]));
        const int height = image.grid.dims[1] * scale / 3;
        for (int n = 0; n < 3; ++n) {
          o.ring_px = n + 1;
          draw_bars(picture, ventricle::radial_profile(slice, labels.axis, labels.circle.radius_px, o), o.ring_px,
                    x + 4, y + n * height, graph_width - 8, height, labels.circle.radius_px);
        }
      });
}

io::Picture draw_sections(const Image& image, const TriMesh& surface, const std::string& title) {
  const TriMesh mesh = to_grid(image.grid, surface);
  return draw_sheet(image, around(image, mesh), title, section_legend, [&](io::Picture&, Tile& tile, int k, int, int) {
    draw_cut(tile, mesh, k, image.grid.spacing, red);
  });
}

io::Picture draw_splash(const std::vector<SplashRow>& rows) {
  constexpr int columns = 8, cell_pixels = 110;
  const Image& first = *rows.front().image;
  const Shown shown = around(first, to_grid(first.grid, rows.front().epi ? *rows.front().epi : *rows.front().endo));
  const int scale = std::max(1, cell_pixels / std::max(shown.window.width, shown.window.height));
  const int width = shown.window.width * scale + gap, height = shown.window.height * scale + line_height + gap;
  io::Picture picture(columns * width + gap, static_cast<int>(rows.size()) * height + gap, background);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const SplashRow& row = rows[r];
    const int top = gap + static_cast<int>(r) * height;
    draw_text(picture, row.name, gap, top, white);
    for (int c = 0; c < columns; ++c) {
      const std::size_t last = shown.slices.size() - 1;
      const int k = shown.slices[static_cast<std::size_t>(c) * last / (columns - 1)];
      Tile tile(picture, gap + c * width, top + line_height, scale, shown.window);
      draw_image(tile, *row.image, k, shown.grey);
      for (const auto& [wall, colour] : {std::pair(row.epi, orange), std::pair(row.endo, blue)})
        if (wall) draw_cut(tile, to_grid(first.grid, *wall), k, first.grid.spacing, colour);
      tile.text(std::to_string(k + 1));
    }
  }
  return picture;
}

io::Picture draw_matrix(const std::vector<std::vector<MatrixCell>>& rows, int slice, MatrixDrawing what,
                        const std::string& title) {
  constexpr int cell_pixels = 180, margin_px = 4, least_picture = 480;
  const ventricle::Circle& around = rows.front().front().borders.coarse;
  const int half = static_cast<int>(std::ceil(around.radius_px)) + margin_px;
  const Window window{static_cast<int>(std::lround(around.x_px)) - half,
                      static_cast<int>(std::lround(around.y_px)) - half, 2 * half + 1, 2 * half + 1};
  const int scale = std::max(1, cell_pixels / window.width);
  const int width = window.width * scale + gap, height = window.height * scale + line_height + gap;
  const Legend& legend = what == MatrixDrawing::edges ? edge_legend : label_legend;
  const int all = std::max(least_picture, static_cast<int>(rows.front().size()) * width + gap);
  const int head = head_height(legend, all);
  io::Picture picture(all, head + static_cast<int>(rows.size()) * height + gap, background);
  draw_head(picture, title, legend);
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      const MatrixCell& cell = rows[r][c];
      const int left = gap + static_cast<int>(c) * width, top = head + gap + static_cast<int>(r) * height;
      draw_text(picture, cell.name.substr(0, static_cast<std::size_t>(std::max(0, width / letter_width))), left,
                top + 2, white);
      Tile tile(picture, left, top + line_height, scale, window);
      const Image& image = cell.borders.study.gates.front();
      if (slice >= image.grid.dims[2]) continue;
      draw_image(tile, image, slice, up_to_brightest(image));
      if (what == MatrixDrawing::edges)
        draw_edge_pixels(tile, cell.borders.gates.front().edges, slice);
      else
        draw_label_marks(tile, cell.borders.gates.front(), cell.borders.coarse, slice);
    }
  return picture;
}

}  // namespace dynasurf::report
