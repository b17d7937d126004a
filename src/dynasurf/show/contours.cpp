#include <algorithm>

#include "dynasurf/core/error.hpp"
#include "dynasurf/dynamics/contour/potential.hpp"
#include "dynasurf/show/detail/palette.hpp"
#include "dynasurf/show/detail/plane.hpp"
#include "dynasurf/show/pictures.hpp"

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
      const int i = static_cast<int>(p[0] + 0.5), j = static_cast<int>(p[1] + 0.5);
      if (image.grid.contains(i, j, 0)) around(i, j, 0) = 1;
    }
  return window_around(around, 5);
}

}  // namespace

Canvas draw_contours(const ContourView& view) {
  const Image& image = *view.image;
  if (view.found.points.empty()) throw InputError("no contour was found in slice " + std::to_string(view.slice + 1));
  Canvas canvas(1160, 600);
  canvas.text({24, 26}, view.title, {14, Anchor::start, ink_of::text, true});
  const LegendEntry entries[] = {
      {"start", ink_of::light}, {"found, with its points", ink_of::epi}, {"pull of the potential", ink_of::warm}};
  draw_legend_row(canvas, {24, 46}, entries);
  const SliceMap map = map_of(image.grid, window_of(image, view.start, view.found), {24, 62, 560, 510});
  draw_slice(canvas, map, image, view.slice, *std::max_element(image.values.begin(), image.values.end()));
  canvas.clip(map.box);
  canvas.line(drawn(map, view.start), {ink_of::light, 1.6});
  canvas.line(drawn(map, view.found), {ink_of::epi, 1.8});
  for (const Contour* contour : {&view.start, &view.found})
    for (const Vec2& p : contour->points) {
      const Vec2 at = map.at(p[0], p[1]);
      canvas.disc(at, 2.2, contour == &view.start ? ink_of::light : ink_of::epi);
      if (view.field == nullptr) continue;
      const Vec2 pull = 2 * dynamics::force_at(*view.field, p);  // the strongest is two pixels long
      canvas.arrow(at, map.at(p[0] + pull[0], p[1] + pull[1]), {ink_of::warm, 1});
    }
  canvas.unclip();
  Scene3d scene;
  for (const auto& [colour, stack] : view.stacks)
    for (std::size_t k = 0; k < stack.size(); ++k) {
      if (!stack[k]) continue;
      std::vector<Vec3> ring;
      for (const Vec2& p : stack[k]->points)
        ring.push_back(to_world(image.grid, Vec3(p[0], p[1], static_cast<double>(k)).cwiseProduct(image.grid.spacing)));
      if (!ring.empty()) ring.push_back(ring.front());
      scene.add_line(ring, colour, 1.4);
    }
  canvas.text({620, 46}, "Propagated stack: inner wall blue, outer wall red", {10});
  if (!scene.empty()) scene.draw(canvas, {610, 62, 530, 510});
  return canvas;
}

}  // namespace dynasurf::show
