#include "dynasurf/dynamics/contour/contours.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/dynamics/contour/detail/curvature.hpp"
#include "dynasurf/show/detail/chart.hpp"
#include "dynasurf/show/detail/palette.hpp"
#include "dynasurf/show/detail/pictures.hpp"
#include "dynasurf/show/detail/plane.hpp"

namespace dynasurf::show {
namespace {

std::vector<Vec2> drawn(const SliceMap& map, const Contour& contour) {
  std::vector<Vec2> line;
  for (const Vec2& p : contour.points) line.push_back(map.at(p[0], p[1]));
  if (contour.closed && !line.empty()) line.push_back(line.front());
  return line;
}

Cutout window_of(const Image& image, const Contour& a, const Contour& b) {
  Image around(image.grid);
  for (const Contour* contour : {&a, &b})
    for (const Vec2& p : contour->points) {
      const int i = round_int(p[0]), j = round_int(p[1]);
      if (image.grid.contains(i, j, 0)) around(i, j, 0) = 1;
    }
  return window_around(around, 5);
}

void draw_points(Canvas& canvas, const SliceMap& map, const Contour& contour, const io::Colour& colour, double radius) {
  for (const Vec2& p : contour.points) canvas.disc(map.at(p[0], p[1]), radius, colour);
}

/// The pull of the field on the points of a contour, and the force by which it straightens itself; the strongest of
/// each kind is two pixels long.
void draw_forces(Canvas& canvas, const SliceMap& map, const Contour& contour, const field::VectorField* field) {
  const auto arrows = [&](const std::vector<Vec2>& forces, const io::Colour& colour) {
    double most = 1e-12;  // where all forces vanish
    for (const Vec2& f : forces) most = std::max(most, f.norm());
    for (std::size_t n = 0; n < forces.size(); ++n) {
      const Vec2 &from = contour.points[n], to = from + 2 / most * forces[n];
      canvas.arrow(map.at(from[0], from[1]), map.at(to[0], to[1]), {colour, 1.1});
    }
  };
  std::vector<Vec2> pull;
  if (field != nullptr)
    for (const Vec2& p : contour.points) pull.push_back(dynamics::force_at(*field, p));
  arrows(pull, ink_of::warm);
  arrows(dynamics::curvature_force(contour, dynamics::curvature_frame(contour)), ink_of::pink);
}

/// Shortest, mean and longest edge of a contour in px.
std::string edges_of(const Contour& contour) {
  double least = 1e300, most = 0;
  for (std::size_t e = 0; e < contour.edges(); ++e) {
    const double length = (contour.end_of_edge(e) - contour.points[e]).norm();
    least = std::min(least, length), most = std::max(most, length);
  }
  return std::to_string(contour.size()) + " points, edges " + number_text(std::round(100 * least) / 100) + " to " +
         number_text(std::round(100 * most) / 100) + " px";
}

void draw_resampling(Canvas& canvas, const ContourView& view, const Panel& box, double most) {
  const SliceMap map = map_of(view.image->grid, window_of(*view.image, view.resampled, view.resampled), box);
  draw_slice(canvas, map, *view.image, view.slice, most);
  canvas.clip(map.box);
  canvas.line(drawn(map, view.unsampled), {ink_of::light, 1});
  canvas.line(drawn(map, view.resampled), {ink_of::epi, 1});
  draw_points(canvas, map, view.unsampled, ink_of::light, 3.2);
  draw_points(canvas, map, view.resampled, ink_of::epi, 2);
  canvas.unclip();
  canvas.text({box.x, box.y - 20}, "From long edges, without resampling: " + edges_of(view.unsampled),
              {10, Anchor::start, ink_of::endo});
  canvas.text({box.x, box.y - 6}, "and with it: " + edges_of(view.resampled), {10, Anchor::start, ink_of::epi});
}

void draw_stack(Canvas& canvas, const ContourView& view, const Panel& box) {
  Scene3d scene;
  const Grid& grid = view.image->grid;
  for (const auto& [colour, stack] : view.stacks)
    for (std::size_t k = 0; k < stack.size(); ++k) {
      if (!stack[k]) continue;
      std::vector<Vec3> ring;
      for (const Vec2& p : stack[k]->points)
        ring.push_back(to_world(grid, Vec3(p[0], p[1], k).cwiseProduct(grid.spacing)));
      if (!ring.empty()) ring.push_back(ring.front());
      scene.add_line(ring, colour, 1.4);
    }
  canvas.text({box.x, box.y - 6}, "Propagated from slice to slice: inner wall blue, outer wall red", {10});
  if (!scene.empty()) scene.draw(canvas, box);
}

}  // namespace

Canvas draw_contours(const ContourView& view) {
  const Image& image = *view.image;
  if (view.found.points.empty()) throw InputError("no contour was found in slice " + std::to_string(view.slice + 1));
  const bool sampled = !view.unsampled.points.empty();
  Canvas canvas(sampled ? 1560 : 1080, 600);
  canvas.text({24, 26}, view.title, {14, Anchor::start, ink_of::text, true});
  const LegendEntry entries[] = {{"start", ink_of::light},
                                 {"found, with its points", ink_of::epi},
                                 {"pull of the potential", ink_of::warm},
                                 {"bending force", ink_of::pink}};
  draw_legend_row(canvas, {24, 50}, entries);
  const double most = *std::max_element(image.values.begin(), image.values.end());
  const SliceMap map = map_of(image.grid, window_of(image, view.start, view.found), {24, 72, 500, 500});
  draw_slice(canvas, map, image, view.slice, most);
  canvas.clip(map.box);
  canvas.line(drawn(map, view.start), {ink_of::light, 1.6});
  canvas.line(drawn(map, view.found), {ink_of::epi, 1.8});
  draw_points(canvas, map, view.start, ink_of::light, 2.2);
  draw_points(canvas, map, view.found, ink_of::epi, 2.2);
  for (const Contour* contour : {&view.start, &view.found}) draw_forces(canvas, map, *contour, view.field);
  canvas.unclip();
  if (sampled) draw_resampling(canvas, view, {554, 72, 450, 500}, most);
  draw_stack(canvas, view, {sampled ? 1044.0 : 560.0, 72, 490, 500});
  return canvas;
}

}  // namespace dynasurf::show
