#include <algorithm>
#include <cmath>
#include <numbers>

#include "dynasurf/core/error.hpp"
#include "dynasurf/show/detail/chart.hpp"
#include "dynasurf/show/detail/palette.hpp"
#include "dynasurf/show/detail/pictures.hpp"

namespace dynasurf::show {
namespace {

constexpr Panel frame{64, 56, 640, 330};

Canvas sheet(const std::string& title) {
  Canvas canvas(760, 460);
  canvas.text({24, 26}, title, {14, Anchor::start, ink_of::text, true});
  return canvas;
}

}  // namespace

Canvas draw_scatter(std::span<const double> distances, const std::string& title) {
  if (distances.empty()) throw InputError("no particle to draw");
  Canvas canvas = sheet(title);
  // One voxel to either side is always in sight: it is what the thesis judges a run by (tables 6.5 to 6.7).
  Interval y = interval_of(distances);
  y = {std::min(y.low, -1.0) - 0.1, std::max(y.high, 1.0) + 0.1};
  const Axes axes{frame,      {0, static_cast<double>(distances.size())}, y, "",
                  "particle", "signed distance, voxels (+ outside)"};
  draw_axes(canvas, axes);
  const Vec2 zero[] = {{0, 0}, {axes.x.high, 0}};
  plot(canvas, axes, zero, {ink_of::text, 1.2});
  std::size_t near = 0, finite = 0;
  for (std::size_t n = 0; n < distances.size(); ++n) {
    if (!std::isfinite(distances[n])) continue;
    ++finite;
    near += std::abs(distances[n]) < 1 ? 1 : 0;
    canvas.disc(axes.at(n, distances[n]), 1.6, ink_of::endo);
  }
  const double share = finite > 0 ? 100.0 * near / finite : 0;
  canvas.text({24, 45},
              number_text(std::round(10 * share) / 10) + " % of " + std::to_string(finite) +
                  " particles are nearer than one voxel to a border voxel's centre",
              {10});
  return canvas;
}

Canvas draw_history(std::span<const std::array<int, 4>> history, const std::string& title) {
  if (history.empty()) throw InputError("no step to draw");
  Canvas canvas = sheet(title);
  // The first three counts each hold the one before: the third and the fourth make up all particles.
  const double all = history[0][2] + history[0][3];
  if (!(all > 0)) throw InputError("a history without particles");
  const Axes axes{frame, {1, std::max(2.0, static_cast<double>(history.size()))}, {0, all}, "", "step", "particles"};
  // Bands one over the other: nearer than 1, 1 to 2, 2 to 3, farther.
  const io::Colour colours[] = {viridis(0.05), viridis(0.4), viridis(0.7), viridis(1)};
  // Each area reaches down to the axis, so the largest is drawn first and the smaller ones cover it.
  for (int band = 3; band >= 0; --band) {
    std::vector<Vec2> area{axes.at(1, 0)};
    for (std::size_t n = 0; n < history.size(); ++n) area.push_back(axes.at(n + 1, band == 3 ? all : history[n][band]));
    area.push_back({area.back()[0], axes.box.bottom()});
    canvas.polygon(area, colours[band]);
  }
  draw_axes(canvas, axes);
  const LegendEntry entries[] = {{"< 1 voxel", colours[0]},
                                 {"1 to 2", colours[1]},
                                 {"2 to 3", colours[2]},
                                 {"3 and more, from a border voxel's centre", colours[3]}};
  draw_legend_row(canvas, {64, 46}, entries);
  return canvas;
}

Canvas draw_curves(std::span<const double> time, const std::string& time_label, std::span<const NamedCurve> curves,
                   const std::string& title) {
  if (time.empty() || curves.empty()) throw InputError("no curve to draw");
  Canvas canvas = sheet(title);
  std::vector<double> all{0};
  for (const NamedCurve& c : curves)
    for (std::size_t n = 0; n < c.value.size(); ++n)
      all.push_back(c.value[n] + (n < c.half_width.size() ? c.half_width[n] : 0));
  Axes axes{frame, interval_of(time), interval_of(all), "", time_label, "volume, mL"};
  axes.y.high *= 1.05;
  draw_axes(canvas, axes);
  std::vector<LegendEntry> entries;
  for (const NamedCurve& c : curves) {
    std::vector<Vec2> line, band;
    const std::size_t instants = std::min(c.value.size(), time.size());
    for (std::size_t n = 0; n < instants; ++n)
      if (std::isfinite(c.value[n])) line.emplace_back(time[n], c.value[n]);
    if (c.half_width.size() == c.value.size()) {
      // One polygon: along the upper ends of the intervals, and back along the lower ones.
      for (std::size_t n = 0; n < instants; ++n) band.push_back(axes.at(time[n], c.value[n] + c.half_width[n]));
      for (std::size_t n = instants; n > 0;) {
        --n;
        band.push_back(axes.at(time[n], c.value[n] - c.half_width[n]));
      }
      canvas.polygon(band, c.colour, 0.2);
    }
    plot(canvas, axes, line, {c.colour, 1.8});
    for (const Vec2& p : line) canvas.disc(axes.at(p[0], p[1]), 3, c.colour);
    entries.push_back({c.name, c.colour});
  }
  draw_legend_row(canvas, {64, 46}, entries);
  return canvas;
}

Canvas draw_areas(const TriMesh& mesh, const std::string& title) {
  if (mesh.triangles.empty()) throw InputError("no triangle to draw");
  std::vector<double> area, d, shape;
  std::vector<io::Colour> colours;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[1]] - mesh.vertices[t[0]], b = mesh.vertices[t[2]] - mesh.vertices[t[1]],
               c = mesh.vertices[t[0]] - mesh.vertices[t[2]];
    area.push_back(a.cross(b).norm() / 2);
    const double longest = std::sqrt(std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()}));
    d.push_back(longest > 0 ? area.back() / longest : 0);
    const double edges = a.squaredNorm() + b.squaredNorm() + c.squaredNorm();
    // 4 sqrt(3) A over the sum of the squared edges: 1 for an equilateral triangle of any size, 0 for a degenerate one,
    // whereas d (GEO-DEGEN) grows with the triangle.
    shape.push_back(edges > 0 ? 4 * std::numbers::sqrt3 * area.back() / edges : 0);
    colours.push_back(viridis(shape.back()));
  }
  Canvas canvas(1180, 620);
  canvas.text({24, 26}, title, {14, Anchor::start, ink_of::text, true});
  const auto graph = [&](double y, const std::vector<double>& values, const io::Colour& colour, const std::string& name,
                         const std::string& label) {
    const Axes axes{{64, y, 560, 210},
                    {0, static_cast<double>(values.size())},
                    {0, 1.05 * std::max(1e-12, interval_of(values).high)},
                    name,
                    "triangle",
                    label};
    draw_axes(canvas, axes);
    for (std::size_t n = 0; n < values.size(); ++n) canvas.disc(axes.at(n, values[n]), 1.2, colour);
  };
  graph(62, area, ink_of::endo, "Area of each triangle", "mm²");
  graph(340, d, ink_of::pink, "d of each triangle: area / longest edge", "mm");
  Scene3d scene;
  scene.add(mesh, colours);
  scene.draw(canvas, {650, 50, 430, 530});
  draw_colour_bar(canvas, {1090, 160, 14, 260}, {0, 1}, "shape, 1: equilateral", viridis);
  return canvas;
}

}  // namespace dynasurf::show
