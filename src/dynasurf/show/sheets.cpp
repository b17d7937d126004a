#include "dynasurf/show/detail/sheets.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/show/detail/palette.hpp"
#include "dynasurf/show/detail/plane.hpp"
#include "dynasurf/ventricle/labels/detail/mlc.hpp"
#include "dynasurf/ventricle/labels/detail/radial.hpp"

namespace dynasurf::show {
namespace {

constexpr io::Colour white{255, 255, 255};
constexpr io::Colour major{240, 228, 66}, minor = ink_of::warm;
constexpr io::Colour outer = ink_of::epi, inner = ink_of::light, either = ink_of::pink;
constexpr io::Colour coarse_grey{150, 150, 150};
constexpr double edge = 24, gap = 8, strip = 14, line_height = 16, tile_points = 192;

/// Values that are drawn black and white.
struct GreyScale {
  float black = 0, white = 0;
};

GreyScale up_to_brightest(const Image& image) {
  return {0, image.values.empty() ? 0 : *std::max_element(image.values.begin(), image.values.end())};
}

/// Of what a window shows, black and white for all but the few darkest and brightest voxels: the rest of an image may
/// hold air and bone.
GreyScale usual_values(const Image& image, const std::vector<int>& slices, const Cutout& w) {
  std::vector<float> values;
  for (const int k : slices)
    for (int j = w.j; j < w.j + w.rows; ++j)
      for (int i = w.i; i < w.i + w.columns; ++i)
        if (image.grid.contains(i, j, k)) values.push_back(image(i, j, k));
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const double last = values.size() - 1;
  return {values[static_cast<std::size_t>(0.01 * last)], values[static_cast<std::size_t>(0.99 * last)]};
}

/// One slice: its voxels as squares, and what is drawn over them. Places are those of the slice: (0, 0) is the centre
/// of its first voxel.
class Tile {
 public:
  Tile(const Cutout& window, double left, double top, int scale)
      : window_(window),
        voxels_(window.columns, window.rows),
        map_{window,
             {left, top, static_cast<double>(window.columns * scale), static_cast<double>(window.rows * scale)},
             static_cast<double>(scale),
             static_cast<double>(scale)} {}

  void paint(const Image& image, int k, const GreyScale& greys) {
    const float range = greys.white - greys.black;
    for (int y = 0; y < window_.rows; ++y)
      for (int x = 0; x < window_.columns; ++x) {
        const int i = window_.i + x, j = window_.j + y;
        if (!image.grid.contains(i, j, k) || !(range > 0)) continue;
        // The eye tells dark greys apart less well than bright ones; the square root lifts them.
        voxels_(x, y) = grey(0.92 * std::sqrt(std::clamp((image(i, j, k) - greys.black) / range, 0.0F, 1.0F)));
      }
  }
  void voxel(int i, int j, const io::Colour& colour) {
    const int x = i - window_.i, y = j - window_.j;
    if (x >= 0 && y >= 0 && x < window_.columns && y < window_.rows) voxels_(x, y) = colour;
  }
  void line(const std::vector<Vec2>& points, const io::Colour& colour, double width = 1.5) {
    lines_.push_back({points, {colour, width}});
  }
  void circle(double i, double j, double radius, const io::Colour& colour) {
    std::vector<Vec2> ring;
    for (int n = 0; n <= 120; ++n) {
      const double a = 2 * std::numbers::pi * n / 120;
      ring.emplace_back(i + radius * own::cos(a), j + radius * own::sin(a));
    }
    line(ring, colour, 1.2);
  }
  void cross(double i, double j, const io::Colour& colour) {
    line({{i - 1, j}, {i + 1, j}}, colour);
    line({{i, j - 1}, {i, j + 1}}, colour);
  }
  void box(double i0, double j0, double i1, double j1, const io::Colour& colour) {
    line({{i0, j0}, {i1, j0}, {i1, j1}, {i0, j1}, {i0, j0}}, colour, 1);
  }
  void mark() { marked_ = true; }
  const Panel& panel() const { return map_.box; }

  void draw(Canvas& canvas) const {
    canvas.raster(voxels_, map_.box);
    canvas.clip(map_.box);
    for (const auto& [points, pen] : lines_) {
      std::vector<Vec2> drawn;
      for (const Vec2& p : points) drawn.push_back(map_.at(p[0], p[1]));
      canvas.line(drawn, pen);
    }
    if (marked_) canvas.frame(map_.box.shrunk(1.5), {white, 3});
    canvas.unclip();
    if (marked_)
      canvas.frame({map_.box.x - 2, map_.box.y - 2, map_.box.width + 4, map_.box.height + 4}, {ink_of::text, 2});
  }

 private:
  Cutout window_;
  io::Picture voxels_;
  SliceMap map_;
  std::vector<std::pair<std::vector<Vec2>, Pen>> lines_;
  bool marked_ = false;
};

/// What a colour means.
struct Key {
  io::Colour colour;
  std::string meaning;
};
using Legend = std::vector<Key>;
const Legend edge_legend{{major, "major edge"}, {minor, "minor edge"}};
const Legend label_legend{
    {outer, "outer border and its box"},  {inner, "inner border and its box"},
    {either, "both, or not told apart"},  {major, "edge left over"},
    {coarse_grey, "coarse circle"},       {white, "automatic circle; cross: axis; frame: division slice"},
    {ink_of::good, "centre in the slice"}};
const Legend ring_legend{{major, "edge inside the circle"},
                         {outer, "peaks: rings with most edge voxels"},
                         {white, "automatic circle"},
                         {ink_of::endo, "bars: edge voxels by distance from the axis, in rings of 1, 2 and 3 px"}};
const Legend section_legend{{outer, "the surface, cut by the slice"}};

constexpr Lettering legend_letters{10};

/// Where each entry of a legend begins, in lines of `width`.
std::vector<Vec2> places_of(const Canvas& canvas, const Legend& legend, double width) {
  std::vector<Vec2> places;
  double x = 0, y = 0;
  for (const Key& key : legend) {
    const double wide = 17 + canvas.width_of(key.meaning, legend_letters) + 16;
    if (x > 0 && x + wide > width) x = 0, y += line_height;
    places.emplace_back(x, y);
    x += wide;
  }
  return places;
}

/// Height of the title and of the legend.
double head_height(const Legend& legend, double width) {
  const Canvas ruler(10, 10);
  return 46 + places_of(ruler, legend, width - 2 * edge).back()[1] + 10;
}

void draw_head(Canvas& canvas, const std::string& title, const Legend& legend) {
  Lettering letters{14, Anchor::start, ink_of::text, true};
  const double room = canvas.width() - 2 * edge;
  if (const double width = canvas.width_of(title, letters); width > room) letters.size *= room / width;
  canvas.text({edge, 26}, title, letters);
  const std::vector<Vec2> places = places_of(canvas, legend, room);
  for (std::size_t n = 0; n < legend.size(); ++n) {
    const double x = edge + places[n][0], y = 46 + places[n][1];
    canvas.rectangle({x, y - 8, 12, 8}, legend[n].colour);
    canvas.frame({x, y - 8, 12, 8}, {ink_of::quiet, 0.6});
    canvas.text({x + 17, y}, legend[n].meaning, legend_letters);
  }
}

/// What of an image a sheet shows.
struct Shown {
  std::vector<int> slices;
  Cutout window;
  GreyScale greys;
  double extra = 0;  // points that are left free to the right of each slice
};

Shown all_of(const Image& image, double extra = 0) {
  Shown shown{{}, {0, 0, image.grid.dims[0], image.grid.dims[1]}, up_to_brightest(image), extra};
  for (int k = 0; k < image.grid.dims[2]; ++k) shown.slices.push_back(k);
  return shown;
}

int scale_of(const Cutout& window, double points) {
  return std::max(1, static_cast<int>(points) / std::max(window.columns, window.rows));
}

/// A sheet with a place for every slice.
Canvas draw_sheet(const Image& image, const Shown& shown, const std::string& title, const Legend& legend,
                  const std::function<void(Canvas&, Tile&, int k)>& draw) {
  const int count = shown.slices.size();
  const int scale = scale_of(shown.window, tile_points);
  const double width = shown.window.columns * scale + shown.extra + gap,
               height = shown.window.rows * scale + strip + gap;
  // A sheet about half as wide again as high.
  const int columns = std::max(1, ceil_int(std::sqrt(count * 1.5 * height / width)));
  const int rows = std::max(1, (count + columns - 1) / columns);
  const double all = std::max(640.0, 2 * edge + columns * width - gap);
  const double head = head_height(legend, all);
  Canvas canvas(all, head + rows * height + edge - gap);
  draw_head(canvas, title, legend);
  for (int n = 0; n < count; ++n) {
    const int k = shown.slices[n], row = n / columns;
    const double left = edge + n % columns * width, top = head + row * height + strip;
    Tile tile(shown.window, left, top, scale);
    tile.paint(image, k, shown.greys);
    draw(canvas, tile, k);
    tile.draw(canvas);
    canvas.text({left, top - 4}, "slice " + std::to_string(k + 1), {9});
  }
  return canvas;
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
  const auto pixel = [&](double at, int axis) { return std::clamp(round_int(at), 0, image.grid.dims[axis] - 1); };
  Shown shown;
  shown.window = {pixel(first[0], 0), pixel(first[1], 1), 0, 0};
  shown.window.columns = pixel(last[0], 0) - shown.window.i + 1;
  shown.window.rows = pixel(last[1], 1) - shown.window.j + 1;
  // Rounded inwards: the slices that the surface meets, with a stride that leaves at most 36.
  const int bottom = pixel(std::ceil(first[2]), 2), top = pixel(std::floor(last[2]), 2);
  const int stride = 1 + (top - bottom) / most_slices;
  for (int k = bottom; k <= std::max(bottom, top); k += stride) shown.slices.push_back(k);
  shown.greys = usual_values(image, shown.slices, shown.window);
  return shown;
}

void draw_box(Tile& tile, const std::vector<image::Pixel>& pixels, const io::Colour& colour) {
  if (pixels.empty()) return;
  const auto [i0, i1] = std::minmax_element(pixels.begin(), pixels.end(), [](auto a, auto b) { return a.i < b.i; });
  const auto [j0, j1] = std::minmax_element(pixels.begin(), pixels.end(), [](auto a, auto b) { return a.j < b.j; });
  tile.box(i0->i - 0.5, j0->j - 0.5, i1->i + 0.5, j1->j + 0.5, colour);
}

/// Bars of the counts of a slice with a scale for their distance.
void draw_bars(Canvas& canvas, const ventricle::RadialProfile& profile, double ring_px, const Panel& box,
               double reach_px) {
  const Vec2 ground[] = {{box.x, box.bottom()}, {box.right(), box.bottom()}};
  canvas.line(ground, {ink_of::text, 0.6});
  const int most = profile.counts.empty() ? 0 : *std::max_element(profile.counts.begin(), profile.counts.end());
  canvas.text({box.x, box.y + 6}, std::to_string(static_cast<int>(ring_px)) + " px, most " + std::to_string(most),
              {7, Anchor::start, ink_of::text});
  for (std::size_t ring = 0; most > 0 && ring < profile.counts.size(); ++ring) {
    const double from = ring * ring_px / reach_px, to = from + ring_px / reach_px;
    if (from >= 1 || profile.counts[ring] == 0) continue;
    const bool peak = std::any_of(profile.peaks_px.begin(), profile.peaks_px.end(),
                                  [&](double r) { return static_cast<std::size_t>(r / ring_px) == ring; });
    const double high = (box.height - 9) * profile.counts[ring] / most;
    canvas.rectangle(
        {box.x + from * box.width, box.bottom() - high, (std::min(to, 1.0) - from) * box.width - 0.4, high},
        peak ? outer : ink_of::endo);
  }
}

void draw_edge_voxels(Tile& tile, const image::EdgeMap& edges, int k) {
  for (int j = 0; j < edges.edges.grid.dims[1]; ++j)
    for (int i = 0; i < edges.edges.grid.dims[0]; ++i)
      if (const int found = edges.edges(i, j, k)) tile.voxel(i, j, found == 1 ? minor : major);
}

void draw_label_marks(Tile& tile, const ventricle::GateBorders& gate, const ventricle::Circle& coarse, int k) {
  const ventricle::Labels& labels = gate.labels;
  draw_edge_voxels(tile, gate.edges, k);
  for (int j = 0; j < labels.borders.grid.dims[1]; ++j)
    for (int i = 0; i < labels.borders.grid.dims[0]; ++i)
      if (const int bits = labels.borders(i, j, k))
        tile.voxel(i, j,
                   bits == ventricle::Labels::endo_bit  ? inner
                   : bits == ventricle::Labels::epi_bit ? outer
                                                        : either);
  draw_box(tile, ventricle::pixels_of(labels.borders, k, ventricle::Labels::epi_bit), outer);
  draw_box(tile, ventricle::pixels_of(labels.borders, k, ventricle::Labels::endo_bit), inner);
  tile.circle(coarse.x_px, coarse.y_px, coarse.radius_px, coarse_grey);
  tile.circle(labels.axis.x_at(k), labels.axis.y_at(k), labels.circle.radius_px, white);
  if (const auto& local = labels.local[k]) tile.cross(local->x_px, local->y_px, ink_of::good);
  tile.cross(labels.axis.x_at(k), labels.axis.y_at(k), white);
  if (k == labels.division_slice) tile.mark();
}

}  // namespace

Canvas draw_edges(const Image& image, const image::EdgeMap& edges, const std::string& title) {
  return draw_sheet(image, all_of(image), title, edge_legend,
                    [&](Canvas&, Tile& tile, int k) { draw_edge_voxels(tile, edges, k); });
}

Canvas draw_labels(const Image& image, const ventricle::GateBorders& gate, const ventricle::Circle& coarse,
                   const std::string& title) {
  return draw_sheet(image, all_of(image), title, label_legend,
                    [&](Canvas&, Tile& tile, int k) { draw_label_marks(tile, gate, coarse, k); });
}

Canvas draw_rings(const Image& image, const ventricle::GateBorders& gate, const ventricle::RadialLabels& options,
                  const std::string& title) {
  constexpr double graph_width = 96;
  const ventricle::Labels& labels = gate.labels;
  const double reach = labels.circle.radius_px;
  const ventricle::SliceEdges edges =
      ventricle::find_components(ventricle::clip(gate.edges.edges, labels.axis, reach), 1);
  return draw_sheet(image, all_of(image, graph_width), title, ring_legend, [&](Canvas& canvas, Tile& tile, int k) {
    const auto& slice = edges[k];
    for (const image::Component& found : slice)
      for (const image::Pixel& p : found.pixels) tile.voxel(p.i, p.j, major);
    ventricle::RadialLabels o = options;
    for (const double radius : ventricle::radial_profile(slice, labels.axis, reach, o).peaks_px)
      tile.circle(labels.axis.x_at(k), labels.axis.y_at(k), radius, outer);
    tile.circle(labels.axis.x_at(k), labels.axis.y_at(k), reach, white);
    const Panel& beside = tile.panel();
    const double height = beside.height / 3;
    for (int n = 0; n < 3; ++n) {
      o.ring_px = n + 1;
      draw_bars(canvas, ventricle::radial_profile(slice, labels.axis, reach, o), o.ring_px,
                {beside.right() + 5, beside.y + n * height + 2, graph_width - 12, height - 4}, reach);
    }
  });
}

Canvas draw_sections(const Image& image, const TriMesh& surface, const std::string& title) {
  const TriMesh mesh = to_grid(image.grid, surface);
  const Vec3& spacing = image.grid.spacing;
  return draw_sheet(image, around(image, mesh), title, section_legend, [&](Canvas&, Tile& tile, int k) {
    for (const auto& polygon : mesh::cross_section(mesh, Vec3(0, 0, k * spacing[2]), Vec3(0, 0, 1))) {
      std::vector<Vec2> cut;
      cut.reserve(polygon.size());
      for (const Vec3& p : polygon) cut.emplace_back(p[0] / spacing[0], p[1] / spacing[1]);
      tile.line(cut, outer);
    }
  });
}

Canvas draw_matrix(const std::vector<std::vector<MatrixCell>>& rows, int slice, MatrixDrawing what,
                   const std::string& title) {
  constexpr double cell_points = 180;
  constexpr int margin_px = 4;
  const ventricle::Circle& about = rows.front().front().borders.coarse;
  const int half = ceil_int(about.radius_px) + margin_px;
  const Cutout window{round_int(about.x_px) - half, round_int(about.y_px) - half, 2 * half + 1, 2 * half + 1};
  const int scale = scale_of(window, cell_points);
  const double width = window.columns * scale + gap, height = window.rows * scale + strip + gap;
  const Legend& legend = what == MatrixDrawing::edges ? edge_legend : label_legend;
  const double all = std::max(480.0, 2 * edge + rows.front().size() * width - gap);
  const double head = head_height(legend, all);
  Canvas canvas(all, head + rows.size() * height + edge - gap);
  draw_head(canvas, title, legend);
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      const MatrixCell& cell = rows[r][c];
      const double left = edge + c * width;
      const double top = head + r * height + strip;
      Lettering letters{9};
      const double long_name = canvas.width_of(cell.name, letters);
      if (long_name > width - gap) letters.size *= (width - gap) / long_name;
      canvas.text({left, top - 4}, cell.name, letters);
      Tile tile(window, left, top, scale);
      const Image& image = cell.borders.study.gates.front();
      if (slice >= image.grid.dims[2]) continue;
      tile.paint(image, slice, up_to_brightest(image));
      if (what == MatrixDrawing::edges)
        draw_edge_voxels(tile, cell.borders.gates.front().edges, slice);
      else
        draw_label_marks(tile, cell.borders.gates.front(), cell.borders.coarse, slice);
      tile.draw(canvas);
    }
  return canvas;
}

}  // namespace dynasurf::show
