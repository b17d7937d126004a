#include <algorithm>
#include <cmath>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/show/detail/palette.hpp"
#include "dynasurf/show/detail/pictures.hpp"
#include "dynasurf/show/detail/plane.hpp"

namespace dynasurf::show {
namespace {

/// What a field has along a row of a slice.
struct Profile {
  std::vector<Vec2> length, along, image;  // place in mm from the first voxel, and the value
  std::vector<double> meetings;            // where `along` changes from + to -, mm
};

Profile profile_of(const field::VectorField& field, const Image* image, const Cutout& w, int row, int k) {
  Profile p;
  const double step = field.grid.spacing[0];
  for (int i = w.i; i < w.i + w.columns; ++i) {
    const std::size_t n = field.grid.index(i, row, k);
    p.length.emplace_back(i * step, Vec3(field.x[n], field.y[n], field.z[n]).norm());
    p.along.emplace_back(i * step, field.x[n]);
    if (image != nullptr) p.image.emplace_back(i * step, (*image)(i, row, k));
  }
  for (std::size_t n = 1; n < p.along.size(); ++n) {
    const double a = p.along[n - 1][1], b = p.along[n][1];
    // From + to - the vectors meet, as they do on a border; from - to + they part, on a medial line (LAB-SIGN).
    if (a > 0 && b <= 0) p.meetings.push_back(p.along[n - 1][0] + step * a / (a - b));
  }
  return p;
}

/// The surroundings of a border, where it is given and the row crosses them; else the whole slice.
Cutout shown_of(const Grid& g, const Image* border, int row) {
  const Cutout shown{0, 0, g.dims[0], g.dims[1]};
  if (border == nullptr) return shown;
  const Cutout near = window_around(*border, 6);
  return row >= near.j && row < near.j + near.rows ? near : shown;
}

Interval up_to(std::span<const Vec2> points) {
  double most = 0;
  for (const Vec2& p : points) most = std::max(most, p[1]);
  return {0, most > 0 ? 1.08 * most : 1};
}

Interval about_zero(std::span<const Vec2> points) {
  double most = 0;
  for (const Vec2& p : points) most = std::max(most, std::abs(p[1]));
  return {most > 0 ? -1.1 * most : -1, most > 0 ? 1.1 * most : 1};
}

void draw_row(Canvas& canvas, const SliceMap& map, int row) {
  const Vec2 ends[] = {map.at(map.window.i - 0.5, row), map.at(map.window.i + map.window.columns - 0.5, row)};
  canvas.line(ends, {ink_of::pink, 1.6});
}

/// Each way with a dot at its end.
void draw_paths(Canvas& canvas, const SliceMap& map, std::span<const std::vector<Vec2>> paths) {
  canvas.clip(map.box);
  for (const std::vector<Vec2>& path : paths) {
    std::vector<Vec2> way;
    way.reserve(path.size());
    for (const Vec2& p : path) way.push_back(map.at(p[0], p[1]));
    canvas.line(way, {ink_of::light, 1});
    if (!way.empty()) canvas.disc(way.back(), 2, ink_of::epi);
  }
  canvas.unclip();
}

void draw_profiles(Canvas& canvas, const Panel& box, const Profile& p) {
  const Interval mm{p.length.front()[0], p.length.back()[0]};
  const double high = (box.height - 120) / 2;
  const Axes size{{box.x, box.y + 18, box.width, high},
                  mm,
                  up_to(p.length),
                  "Length along the line",
                  "mm along the line",
                  "|v|, 1/mm"};
  draw_axes(canvas, size);
  if (!p.image.empty()) {
    const double most = up_to(p.image).high;
    std::vector<Vec2> scaled;
    // The image has no unit in common with the field: it is scaled until both peaks are equally high.
    for (const Vec2& at : p.image) scaled.emplace_back(at[0], at[1] / most * size.y.high);
    plot(canvas, size, scaled, {ink_of::epi, 1.2});
  }
  plot(canvas, size, p.length, {ink_of::endo, 1.6});
  const LegendEntry entries[] = {{"|v|", ink_of::endo}, {"image, largest at the top", ink_of::epi}};
  draw_legend_row(canvas, {box.right() - 195, box.y + 12}, entries);

  const Axes sign{{box.x, size.box.bottom() + 62, box.width, high},
                  mm,
                  about_zero(p.along),
                  "Part along the line, with its sign",
                  "mm along the line",
                  "v along the line, 1/mm"};
  draw_axes(canvas, sign);
  const Vec2 zero[] = {{mm.low, 0}, {mm.high, 0}};
  plot(canvas, sign, zero, {ink_of::text, 0.8});
  plot(canvas, sign, p.along, {ink_of::good, 1.6});
  for (const double at : p.meetings) canvas.disc(sign.at(at, 0), 3.5, ink_of::warm);
  const LegendEntry met[] = {{"vectors meet", ink_of::warm}};
  draw_legend_row(canvas, {box.right() - 100, sign.box.y - 6}, met);
}

}  // namespace

Canvas draw_slice_view(const SliceView& view) {
  const Grid& g = view.field->grid;
  if (view.slice < 0 || view.slice >= g.dims[2] || view.row < 0 || view.row >= g.dims[1])
    throw OptionError("slice or row outside the stack of " + std::to_string(g.dims[2]) + " slices with " +
                      std::to_string(g.dims[1]) + " rows");
  Canvas canvas(960, 800);
  canvas.text({24, 26}, view.title, {14, Anchor::start, ink_of::text, true});
  const Cutout shown = shown_of(g, view.border, view.row);
  const double longest = longest_in(*view.field, shown, view.slice);
  canvas.text({24, 48}, "Vectors: direction by arrow, length by colour", {11, Anchor::start, ink_of::text, true});
  const SliceMap top = map_of(g, shown, {24, 56, 360, 340});
  draw_vectors(canvas, top, *view.field, view.slice, longest);
  draw_row(canvas, top, view.row);
  draw_colour_bar(canvas, {top.box.right() + 10, top.box.y + 20, 12, 200}, {0, longest}, "length in the slice, 1/mm",
                  viridis);
  const double brightest = *std::max_element(view.image->values.begin(), view.image->values.end());
  canvas.text({24, 420},
              view.paths.empty() ? "Image, white: the largest value of the stack"
                                 : "Image; ways of the particles that end in the slice",
              {11, Anchor::start, ink_of::text, true});
  const SliceMap below = map_of(g, shown, {24, 428, 360, 340});
  draw_slice(canvas, below, *view.image, view.slice, brightest);
  draw_paths(canvas, below, view.paths);
  canvas.frame(below.box, {ink_of::text, 0.6});
  draw_row(canvas, below, view.row);
  draw_profiles(canvas, {530, 50, 400, 540}, profile_of(*view.field, view.image, shown, view.row, view.slice));
  double y = 640;
  canvas.text({494, y}, "Parameters", {11, Anchor::start, ink_of::text, true});
  for (const auto& [name, value] : view.parameters) {
    y += 17;
    canvas.text({494, y}, name, {10});
    canvas.text({610, y}, value, {10});
  }
  return canvas;
}

Canvas draw_field_grid(std::span<const NamedField> fields, int across, int slice, int row, const std::string& title,
                       const Image* border) {
  if (fields.empty() || across < 1) throw InputError("no field to draw");
  constexpr double side = 250, graph = 70, gap_x = 84, gap_y = 92, head = 56;
  const int down = (std::ssize(fields) + across - 1) / across;
  Canvas canvas(across * (side + gap_x) + 60, head + down * (side + graph + gap_y));
  canvas.text({24, 26}, title, {14, Anchor::start, ink_of::text, true});
  const Grid& g = fields[0].field.grid;
  const Cutout shown = shown_of(g, border, row);
  for (std::size_t n = 0; n < fields.size(); ++n) {
    const field::VectorField& field = fields[n].field;
    const double x = 56 + (n % across) * (side + gap_x);
    const std::size_t above = n / across;
    const double y = head + above * (side + graph + gap_y);
    canvas.text({x, y - 6}, fields[n].name, {11, Anchor::start, ink_of::text, true});
    const double longest = longest_in(field, shown, slice);
    const SliceMap map = map_of(g, shown, {x, y, side, side});
    draw_vectors(canvas, map, field, slice, longest);
    draw_row(canvas, map, row);
    draw_colour_bar(canvas, {map.box.right() + 6, y + 20, 8, 140}, {0, longest}, "1/mm", viridis);
    const Profile p = profile_of(field, nullptr, shown, row, slice);
    const Axes axes{{x, y + side + 22, side, graph},
                    {p.length.front()[0], p.length.back()[0]},
                    up_to(p.length),
                    "",
                    "mm along the line",
                    "|v|, 1/mm"};
    draw_axes(canvas, axes);
    plot(canvas, axes, p.length, {ink_of::endo, 1.4});
  }
  return canvas;
}

Canvas draw_sections_of(const Image& image, std::span<const NamedSurface> surfaces, const std::string& title) {
  const Grid& g = image.grid;
  std::vector<TriMesh> in_grid;
  Image around(g);
  for (const NamedSurface& s : surfaces) {
    in_grid.push_back(to_grid(g, s.mesh));
    for (const Vec3& p : in_grid.back().vertices)
      if (const Index3 v = voxel_of(g, p); g.contains(v[0], v[1], v[2])) around(v[0], v[1], v[2]) = 1;
  }
  const Cutout window = window_around(around, 4);
  // In the frame of the grid slice k lies at k times the spacing.
  std::vector<int> met;
  for (int k = 0; k < g.dims[2]; ++k)
    if (std::any_of(in_grid.begin(), in_grid.end(), [&](const TriMesh& mesh) {
          return !mesh::cross_section(mesh, Vec3(0, 0, k * g.spacing[2]), Vec3(0, 0, 1)).empty();
        }))
      met.push_back(k);
  if (met.empty()) throw InputError("no surface meets the image");
  const std::size_t drawn = std::min<std::size_t>(12, met.size());
  constexpr double side = 210, gap = 30;
  const std::size_t across = std::min<std::size_t>(4, drawn), down = (drawn + across - 1) / across;
  Canvas canvas(std::max(560.0, 24 + across * (side + 12)), 64 + down * (side + gap));
  canvas.text({24, 26}, title, {14, Anchor::start, ink_of::text, true});
  std::vector<LegendEntry> entries;
  for (const NamedSurface& s : surfaces) entries.push_back({s.name, s.colour});
  draw_legend_row(canvas, {24, 46}, entries);
  const double most = *std::max_element(image.values.begin(), image.values.end());
  for (std::size_t n = 0; n < drawn; ++n) {
    // Evenly spaced, the first and the last slice that a surface meets among them.
    const int k = met[drawn == 1 ? 0 : n * (met.size() - 1) / (drawn - 1)];
    const double x = 24 + (n % across) * (side + 12);
    const std::size_t above = n / across;
    const double y = 80 + above * (side + gap);
    const SliceMap map = map_of(g, window, {x, y, side, side});
    draw_slice(canvas, map, image, k, most);
    canvas.clip(map.box);
    for (std::size_t s = 0; s < surfaces.size(); ++s)
      for (const auto& polygon : mesh::cross_section(in_grid[s], Vec3(0, 0, k * g.spacing[2]), Vec3(0, 0, 1))) {
        std::vector<Vec2> line;
        line.reserve(polygon.size());
        for (const Vec3& p : polygon) line.push_back(map.at(p[0] / g.spacing[0], p[1] / g.spacing[1]));
        canvas.line(line, {surfaces[s].colour, 1.8});
      }
    canvas.unclip();
    canvas.text({map.box.x, map.box.y - 4}, "slice " + std::to_string(k + 1), {10});
    if (n == 0) {
      const double mm = 20, length = mm / g.spacing[0] * map.column;
      canvas.rectangle({map.box.right() - length - 6, map.box.bottom() - 8, length, 2}, {255, 255, 255});
      canvas.text({map.box.right() - 6, map.box.bottom() - 12}, "20 mm", {9, Anchor::end, {255, 255, 255}});
    }
  }
  return canvas;
}

}  // namespace dynasurf::show
