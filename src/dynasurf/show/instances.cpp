#include <algorithm>
#include <cmath>
#include <numbers>

#include "dynasurf/cloud/lod.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/show/detail/chart.hpp"
#include "dynasurf/show/detail/palette.hpp"
#include "dynasurf/show/detail/pictures.hpp"

namespace dynasurf::show {
namespace {

constexpr int across = 8, down = 25;  // 200 instances
constexpr double width = 1300, height = 760, head = 90;

/// A body seen by an observer who stands above the rows and looks along them. Lengths in steps between bodies.
struct Instance {
  double x = 0, y = 0;  // of its middle in the drawing
  double points_per_step = 0;
  Outlook outlook;
};

Instance instance_at(int column, int row) {
  constexpr double focal = 855, eye = 3.2, nearest = 5, step = 1.1, horizon = head + 10;
  const double far = nearest + step * row;
  Instance i;
  i.points_per_step = focal / far;
  i.x = width / 2 + (column - 0.5 * (across - 1)) * i.points_per_step;
  i.y = horizon + eye * i.points_per_step;
  i.outlook = {25 + 37.0 * (row * across + column), own::atan2(eye, far) * 180 / std::numbers::pi};
  return i;
}

}  // namespace

Canvas draw_instances(std::span<const TriMesh> levels, const std::string& title) {
  const cloud::LodChain chain = cloud::lod_chain(levels);
  const double step = 1.3 * chain.diagonal;
  std::vector<int> drawn(levels.size());
  Canvas canvas(width, height);
  for (int row = down - 1; row >= 0; --row)
    for (int column = 0; column < across; ++column) {
      const Instance i = instance_at(column, row);
      const double side = chain.diagonal / step * i.points_per_step;
      const std::size_t level = cloud::level_for_size(chain, side);
      ++drawn[level];
      Scene3d scene;
      const double share = levels.size() > 1 ? 1.0 * level / (levels.size() - 1) : 0;
      scene.add(levels[level], viridis(0.25 + 0.7 * share), 1, Scene3d::Look::both);
      scene.draw(canvas, {i.x - side, i.y - side, 2 * side, 2 * side}, i.outlook, step / i.points_per_step, false);
    }
  canvas.text({24, 26}, title, {14, Anchor::start, ink_of::text, true});
  std::vector<LegendEntry> entries;
  std::size_t triangles = 0;
  for (std::size_t n = 0; n < levels.size(); ++n) {
    const double share = levels.size() > 1 ? 1.0 * n / (levels.size() - 1) : 0;
    entries.push_back({std::to_string(levels[n].triangles.size()) + " triangles, " + std::to_string(drawn[n]) + " of " +
                           std::to_string(across * down) + " bodies",
                       viridis(0.25 + 0.7 * share)});
    triangles += levels[n].triangles.size() * drawn[n];
  }
  draw_legend_row(canvas, {24, 46}, entries);
  const std::size_t whole = levels[0].triangles.size() * (across * down);
  canvas.text({24, 66},
              std::to_string(triangles) + " triangles in all; " + std::to_string(whole) +
                  " at the finest level. A level serves while its edges are no longer than " +
                  number_text(chain.rule.edge_px) + " points.",
              {10});
  return canvas;
}

}  // namespace dynasurf::show
