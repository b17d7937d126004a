// Contours and nets in the plane (thesis 3.3.1, 3.3.2): a classical snake stops at the mouth of a U, gradient vector
// flow takes it in; a topological net splits into one net per object and finds the hole of a ring. Draws snakes.svg and
// nets.svg.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "dynasurf/dynamics/contour/net.hpp"
#include "dynasurf/dynamics/contour/potential.hpp"
#include "dynasurf/dynamics/contour/snake.hpp"
#include "dynasurf/field/gvf.hpp"

#include "svg.hpp"

using namespace dynasurf;

namespace {

template <class Inside>
Image painted(Inside inside) {
  Grid grid;
  grid.dims = {64, 64, 1};
  Image plane(grid);
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) plane(i, j, 0) = inside(Vec2(i, j)) ? 1.0F : 0.0F;
  return plane;
}

/// Lowest place between the arms of the U that a contour has reached.
double depth_of(const Contour& c) {
  double lowest = 64;
  for (std::size_t e = 0; e < c.edges(); ++e)
    if (const Vec2 p = (c.points[e] + c.end_of_edge(e)) / 2; std::abs(p.x() - 31.5) < 3 && p.y() > 20)
      lowest = std::min(lowest, p.y());
  return lowest;
}

void draw(Drawing& drawing, const Contour& c, const char* colour) {
  std::vector<Vec2> line = c.points;
  line.push_back(c.points.front());
  drawing.line(line, colour);
}

bool show_snakes() {
  const Image u = painted([](const Vec2& p) {
    return p.x() >= 14 && p.x() < 50 && p.y() >= 14 && p.y() < 48 && !(p.x() >= 25 && p.x() < 39 && p.y() >= 24);
  });
  Image edges = snake_energy(u, SnakeEnergy::gradient);
  for (float& v : edges.values) v = std::min(1.0F, -4 * v);
  const VectorField gradient = scaled_to_one(force_of(snake_energy(u, SnakeEnergy::smoothed_gradient, 2)));
  VectorField flow = flow_field(edges, SteadyGvf{}).field;
  for (std::size_t n = 0; n < flow.x.size(); ++n)  // directions alone: the flow is weak far from the border
    if (const float length = std::hypot(flow.x[n], flow.y[n]); length > 0) flow.x[n] /= length, flow.y[n] /= length;

  const Contour start = circle_contour({31.5, 31}, 27, 1.5);
  Snake options;
  options.alpha = 0.1;
  const Contour classic = evolve_snake(start, gradient, options).contour;
  const Contour led = evolve_snake(start, flow, options).contour;
  std::printf(
      "snake by image energy: mouth entered down to %.1f px; by gradient vector flow: %.1f px (floor at 23.5)\n",
      depth_of(classic), depth_of(led));
  Drawing drawing;
  drawing.line({{13.5, 13.5},
                {49.5, 13.5},
                {49.5, 47.5},
                {38.5, 47.5},
                {38.5, 23.5},
                {24.5, 23.5},
                {24.5, 47.5},
                {13.5, 47.5},
                {13.5, 13.5}},
               "silver");
  draw(drawing, start, "gray");
  draw(drawing, classic, "crimson");
  draw(drawing, led, "seagreen");
  drawing.save("snakes.svg");
  return depth_of(classic) > 40 && depth_of(led) < 26;
}

bool show_nets() {
  const Image plane = painted([](const Vec2& p) {
    const double ring = (p - Vec2(20, 40)).norm();
    return (ring < 16 && ring > 7) || (p - Vec2(48, 16)).norm() < 9;
  });
  const std::vector<Net> nets = fit_topological_nets(plane, {});
  Drawing drawing;
  drawing.line({{0, 0}, {63, 0}, {63, 63}, {0, 63}, {0, 0}}, "silver");
  int holes = 0;
  for (const Net& net : nets) {
    const NetShape shape = shape_of(net);
    holes += shape.holes;
    std::printf("net of %zu nodes: %d broken links, %d holes\n", net.nodes.size(), net.broken_links, shape.holes);
    for (const auto& q : net.quads)
      drawing.line({net.nodes[q[0]], net.nodes[q[1]], net.nodes[q[2]], net.nodes[q[3]], net.nodes[q[0]]}, "steelblue");
  }
  drawing.save("nets.svg");
  return nets.size() == 2 && holes == 1;
}

}  // namespace

int main() {
  const bool snakes = show_snakes(), nets = show_nets();
  return snakes && nets ? 0 : 1;
}
