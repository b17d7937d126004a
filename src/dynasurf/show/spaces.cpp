#include <algorithm>
#include <cmath>
#include <numbers>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/motion.hpp"
#include "dynasurf/mesh/smooth.hpp"
#include "dynasurf/show/detail/chart.hpp"
#include "dynasurf/show/detail/palette.hpp"
#include "dynasurf/show/detail/pictures.hpp"

namespace dynasurf::show {
namespace {

std::optional<io::Colour> above_zero(float value, const io::Colour& colour) {
  return value > 0 ? std::optional(colour) : std::nullopt;
}

std::vector<std::size_t> non_zero(const Image& image) {
  std::vector<std::size_t> found;
  for (std::size_t n = 0; n < image.values.size(); ++n)
    if (image.values[n] > 0) found.push_back(n);
  return found;
}

Vec3 place_of(const Grid& g, std::size_t n) { return centre_of(g, voxel_in(g.dims, n)); }

/// A line that follows the field in steps of half a voxel until it turns back: it has reached a border.
std::vector<Vec3> follow(const field::VectorField& field, Vec3 at) {
  constexpr int most = 120;
  std::vector<Vec3> line{at};
  const double step = 0.5 * field.grid.spacing.minCoeff();
  Vec3 before = Vec3::Zero();
  for (int n = 0; n < most; ++n) {
    const Vec3 v = field::sample(field, at, field::Sampling::trilinear);
    if (v.norm() < 1e-12) break;
    const Vec3 way = v.normalized();
    if (way.dot(before) < 0) break;
    at += step * way;
    line.push_back(at);
    before = way;
  }
  return line;
}

}  // namespace

Canvas draw_field_3d(const field::VectorField& field, const Image& border, const std::string& title) {
  const std::vector<std::size_t> voxels = non_zero(border);
  if (voxels.empty()) throw InputError("no border to draw the field around");
  const Grid& g = field.grid;
  std::vector<double> lengths(g.size());
  for (std::size_t n = 0; n < lengths.size(); ++n) lengths[n] = Vec3(field.x[n], field.y[n], field.z[n]).norm();
  // The largest vectors are few: colours end where one of fifty is longer.
  const double longest = std::max(of_rank(lengths, lengths.size() * 49 / 50), 1e-12);
  Scene3d scene;
  scene.add_voxels(
      border, [](float v) { return above_zero(v, ink_of::light); }, 0.35);
  Vec3 low = place_of(g, voxels[0]), top = low;
  for (const std::size_t n : voxels) low = low.cwiseMin(place_of(g, n)), top = top.cwiseMax(place_of(g, n));
  const Vec3 middle = 0.5 * (low + top);
  // Glyphs in the middle slice across y; lines from a box around the border.
  const int j = round_int(middle[1] / g.spacing[1]);
  for (int k = 0; k < g.dims[2]; ++k)
    for (int i = 0; i < g.dims[0]; i += 2) {
      const std::size_t n = g.index(i, j, k);
      if (lengths[n] < 1e-3 * longest) continue;
      const Vec3 half = 0.8 * g.spacing.minCoeff() / lengths[n] * Vec3(field.x[n], field.y[n], field.z[n]);
      const Vec3 at = centre_of(g, {i, j, k});
      const Vec3 ends[] = {at - half, at + half};
      scene.add_line(ends, viridis(lengths[n] / longest), 1.1);
      scene.add_point(ends[1], viridis(lengths[n] / longest), 1.5);
    }
  const Vec3 half = 0.5 * (top - low) + 3 * g.spacing;
  for (int ring = -2; ring <= 2; ++ring)
    for (int n = 0; n < 24; ++n) {
      const double a = 2 * std::numbers::pi * n / 24;
      const Vec3 start = middle + Vec3(half[0] * own::cos(a), half[1] * own::sin(a), 0.45 * ring * half[2]);
      for (const std::vector<Vec3> line = follow(field, start); const Vec3& p : line) {
        const double length = field::sample(field, p, field::Sampling::trilinear).norm();
        if (&p != line.data()) {
          const Vec3 piece[] = {*(&p - 1), p};
          scene.add_line(piece, viridis(length / longest), 1.3);
        }
      }
    }
  Canvas canvas(900, 720);
  canvas.text({24, 26}, title, {14, Anchor::start, ink_of::text, true});
  const LegendEntry entries[] = {{"border voxels", ink_of::light}};
  draw_legend_row(canvas, {24, 46}, entries);
  scene.draw(canvas, {24, 60, 770, 640});
  draw_colour_bar(canvas, {810, 200, 14, 280}, {0, longest}, "length, 1/mm", viridis);
  return canvas;
}

Canvas draw_voxels(std::span<const NamedVoxels> sets, const std::string& title) {
  Scene3d scene;
  std::vector<LegendEntry> entries;
  for (const NamedVoxels& s : sets) {
    scene.add_voxels(
        s.values, [&](float v) { return above_zero(v, s.colour); }, s.opacity, true);
    entries.push_back({s.name + ": " + std::to_string(non_zero(s.values).size()) + " voxels", s.colour});
  }
  if (scene.empty()) throw InputError("no voxel to draw");
  Canvas canvas(820, 720);
  canvas.text({24, 26}, title, {14, Anchor::start, ink_of::text, true});
  draw_legend_row(canvas, {24, 46}, entries);
  scene.draw(canvas, {24, 60, 772, 640});
  return canvas;
}

Canvas draw_voxel_map(const Image& map, const std::string& title, const std::string& unit) {
  const double most = *std::max_element(map.values.begin(), map.values.end());
  const double least = *std::min_element(map.values.begin(), map.values.end());
  if (!(most > 0)) throw InputError("no voxel above 0 to draw");
  const double bottom = least + 0.25 * (most - least);
  Image open = map;  // its front half
  for (int k = 0; k < map.grid.dims[2]; ++k)
    for (int j = 0; j < map.grid.dims[1] / 2; ++j)
      for (int i = 0; i < map.grid.dims[0]; ++i) open(i, j, k) = 0;
  Scene3d scene;
  scene.add_voxels(open, [&](float v) {
    // A map of one value has no range to cut a quarter of: all its voxels are drawn.
    return v > bottom || (most == least && v > 0)
               ? std::optional(viridis((v - bottom) / std::max(1e-12, most - bottom)))
               : std::nullopt;
  });
  Canvas canvas(900, 720);
  canvas.text({24, 26}, title, {14, Anchor::start, ink_of::text, true});
  canvas.text({24, 46}, "cut open in the middle; voxels above a quarter of the range", {10});
  scene.draw(canvas, {24, 60, 770, 640});
  draw_colour_bar(canvas, {810, 200, 14, 280}, {bottom, most > bottom ? most : bottom + 1}, unit, viridis);
  return canvas;
}

Canvas draw_mesh(std::span<const NamedSurface> surfaces, std::span<const NamedVoxels> voxels,
                 const std::string& title) {
  constexpr double side = 440, gap = 20;
  const bool over_voxels = !voxels.empty();
  Canvas canvas(48 + (over_voxels ? 2 : 3) * (side + gap) - gap, 64 + (over_voxels ? 2 : 1) * (side + gap));
  canvas.text({24, 26}, title, {14, Anchor::start, ink_of::text, true});
  std::vector<LegendEntry> entries;
  for (const NamedSurface& s : surfaces) entries.push_back({s.name, s.colour});
  for (const NamedVoxels& v : voxels) entries.push_back({v.name, v.colour});
  draw_legend_row(canvas, {24, 46}, entries);
  // The first surface is the innermost: what lies around it is translucent, or left to its wires.
  const auto with_all = [&](Scene3d::Look first, Scene3d::Look around, double outer) {
    Scene3d scene;
    for (std::size_t n = 0; n < surfaces.size(); ++n)
      scene.add(surfaces[n].mesh, surfaces[n].colour, n == 0 ? 1 : outer, n == 0 ? first : around);
    return scene;
  };
  using Look = Scene3d::Look;
  std::vector<std::pair<std::string, Scene3d>> panels{{"flat faces", with_all(Look::both, Look::shaded, 0.3)},
                                                      {"smooth", with_all(Look::smooth, Look::wires, 0.5)},
                                                      {"wires", with_all(Look::wires, Look::wires, 0.7)}};
  if (over_voxels) {
    Scene3d both;
    for (const NamedVoxels& v : voxels)
      both.add_voxels(
          v.values, [&](float x) { return above_zero(x, v.colour); }, v.opacity, true);
    for (const NamedSurface& s : surfaces) both.add(s.mesh, s.colour, 1, Look::wires);
    panels.emplace_back("wires over the border's voxels", std::move(both));
  }
  // The last panel holds all that any other does: at its scale every panel fits.
  const double scale = panels.back().second.fitting_scale({0, 0, side, side});
  const std::size_t across = over_voxels ? 2 : 3;
  for (std::size_t n = 0; n < panels.size(); ++n) {
    const double x = 24 + (n % across) * (side + gap);
    const std::size_t above = n / across;
    const double y = 64 + above * (side + gap);
    canvas.text({x, y + 10}, panels[n].first, {11, Anchor::start, ink_of::text, true});
    panels[n].second.draw(canvas, {x, y, side, side}, {}, scale);
  }
  return canvas;
}

Canvas draw_cycle(std::span<const std::vector<NamedSurface>> walls, const std::string& title) {
  constexpr double side = 150;
  std::size_t gates = 0;
  double scale = 0;
  for (const auto& wall : walls) gates = std::max(gates, wall.size());
  if (gates == 0) throw InputError("no surface to draw");
  const Panel box{0, 0, side, side};
  const auto scene_of = [](const NamedSurface& s) {
    Scene3d scene;
    scene.add(s.mesh, s.colour);
    return scene;
  };
  // All scenes at the scale of the largest surface: what is drawn larger is larger.
  for (const auto& wall : walls)
    for (const NamedSurface& s : wall) scale = std::max(scale, scene_of(s).fitting_scale(box));
  Canvas canvas(std::max(480.0, 48 + gates * side), 60 + walls.size() * (side + 20));
  canvas.text({24, 26}, title, {14, Anchor::start, ink_of::text, true});
  for (std::size_t w = 0; w < walls.size(); ++w)
    for (std::size_t g = 0; g < walls[w].size(); ++g) {
      const double x = 24 + g * side, y = 50 + w * (side + 20);
      scene_of(walls[w][g]).draw(canvas, {x, y + 6, side, side}, {}, scale);
      canvas.text({x + side / 2, y}, walls[w][g].name, {10, Anchor::middle});
    }
  return canvas;
}

namespace {

/// A mesh on its way in a box, at a scale and in a place that all frames share.
void draw_frame(Canvas& canvas, const Panel& box, const EvolutionFrame& frame, const EvolutionFrame& first,
                const Image& border) {
  Scene3d scene;
  scene.add_voxels(
      border, [](float v) { return above_zero(v, ink_of::light); }, 0.15);
  Vec3 low = first.mesh.vertices[0], high = low;
  for (const Vec3& p : first.mesh.vertices) low = low.cwiseMin(p), high = high.cwiseMax(p);
  scene.make_room(low, high);
  scene.add(frame.mesh, ink_of::quiet, 0.9, Scene3d::Look::wires);
  for (std::size_t v = 0; v < frame.mesh.vertices.size(); ++v)
    scene.add_point(frame.mesh.vertices[v], frame.stopped[v] ? ink_of::epi : ink_of::endo, 1.7);
  scene.draw(canvas, box);
  const auto stopped = std::count(frame.stopped.begin(), frame.stopped.end(), true);
  canvas.text({box.x + box.width / 2, box.y + 4},
              "step " + std::to_string(frame.step) + ": " + std::to_string(stopped) + " of " +
                  std::to_string(frame.stopped.size()) + " stopped",
              {10, Anchor::middle});
}

void draw_evolution_head(Canvas& canvas, const std::string& title) {
  Lettering letters{14, Anchor::start, ink_of::text, true};
  const double room = canvas.width() - 48;
  if (const double width = canvas.width_of(title, letters); width > room) letters.size *= room / width;
  canvas.text({24, 26}, title, letters);
  const LegendEntry entries[] = {{"moving", ink_of::endo}, {"stopped", ink_of::epi}, {"border", ink_of::light}};
  draw_legend_row(canvas, {24, 46}, entries);
}

}  // namespace

Canvas draw_evolution(std::span<const EvolutionFrame> frames, const Image& border, const std::string& title) {
  if (frames.empty()) throw InputError("no step to draw");
  constexpr double side = 290;
  constexpr std::size_t across = 4;
  const std::size_t down = (frames.size() + across - 1) / across;
  Canvas canvas(48 + std::min(across, frames.size()) * side, 64 + down * (side + 16));
  draw_evolution_head(canvas, title);
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const std::size_t above = n / across;
    draw_frame(canvas, {24 + (n % across) * side, 64 + above * (side + 16), side, side}, frames[n], frames[0], border);
  }
  return canvas;
}

Film film_of_evolution(std::span<const EvolutionFrame> frames, const Image& border, const std::string& title) {
  if (frames.empty()) throw InputError("no step to draw");
  constexpr int rest = 10;  // frames that the last one stays
  Film film;
  for (std::size_t n = 0; n < frames.size() + rest; ++n) {
    Canvas canvas(560, 580);
    draw_evolution_head(canvas, title);
    draw_frame(canvas, {24, 64, 512, 500}, frames[std::min(n, frames.size() - 1)], frames[0], border);
    film.frames.push_back(std::move(canvas));
  }
  return film;
}

Film film_of_beat(std::span<const std::vector<TriMesh>> walls, std::span<const io::Colour> colours, double beat_ms,
                  const std::string& title) {
  constexpr int frames = 40;
  Film film{{}, 50};
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (const auto& wall : walls)
    for (const TriMesh& mesh : wall)
      for (const Vec3& p : mesh.vertices) low = low.cwiseMin(p), high = high.cwiseMax(p);
  for (int n = 0; n < frames; ++n) {
    const double phase = 1.0 * n / frames;
    Scene3d scene;
    scene.make_room(low, high);
    std::vector<LegendEntry> entries;
    for (std::size_t w = 0; w < walls.size(); ++w) {
      if (walls[w].empty()) continue;
      const TriMesh mesh = mesh::at_phase(walls[w], phase, mesh::TimeInterpolation::periodic_cubic);
      scene.add(mesh, colours[w], 0.5, w == 0 ? Scene3d::Look::smooth : Scene3d::Look::wires);
      const double ml = std::round(mesh::volume_mm3(mesh) / 100) / 10;
      entries.push_back({std::string(w == 0 ? "inner wall " : "outer wall ") + number_text(ml) + " mL", colours[w]});
    }
    if (scene.empty()) throw InputError("no surface to draw");
    Canvas canvas(560, 580);
    canvas.text({24, 26}, title, {14, Anchor::start, ink_of::text, true});
    draw_legend_row(canvas, {24, 46}, entries);
    const std::string when = beat_ms > 0 ? number_text(std::round(phase * beat_ms)) + " ms"
                                         : number_text(std::round(100 * phase)) + " % of the beat";
    canvas.text({536, 46}, when, {10, Anchor::end});
    scene.draw(canvas, {24, 64, 512, 500});
    film.frames.push_back(std::move(canvas));
  }
  return film;
}

Canvas draw_smoothing(const TriMesh& before, const TriMesh& after, const std::string& title) {
  Canvas canvas(1060, 560);
  canvas.text({24, 26}, title, {14, Anchor::start, ink_of::text, true});
  constexpr double most = 0.5;  // rad; smoothing begins at 0.2 (GEO-SMOOTH)
  const auto half = [&](const TriMesh& mesh, double x, const std::string& name) {
    const std::vector<double> deficits = mesh::angle_deficits(mesh);
    std::vector<io::Colour> colours;
    double mean = 0;
    for (const double d : deficits) mean += std::abs(d) / deficits.size();
    for (const auto& t : mesh.triangles)
      colours.push_back(
          viridis((std::abs(deficits[t[0]]) + std::abs(deficits[t[1]]) + std::abs(deficits[t[2]])) / (3 * most)));
    Scene3d scene;
    scene.add(mesh, colours);
    canvas.text({x, 52}, name + ": " + number_text(mean) + " rad on average", {11, Anchor::start, ink_of::text, true});
    scene.draw(canvas, {x, 60, 460, 480});
  };
  half(before, 24, "before");
  half(after, 494, "after");
  draw_colour_bar(canvas, {968, 160, 14, 260}, {0, most}, "missing or excess angle, rad", viridis);
  return canvas;
}

}  // namespace dynasurf::show
