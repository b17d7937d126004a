// Contours and nets in the plane (thesis 3.3.1, 3.3.2): a classical snake stops at the mouth of a U, gradient vector
// flow takes it in; an active net wraps two objects in one piece, a topological net splits into one net per object and
// finds the hole of a ring; a discrete contour follows what a user draws where the image shows nothing (3.3.3). Draws
// snakes.svg, nets.svg and stroke.svg.
#include "dynasurf/dynamics/contour/contours.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

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
  Image edges = dynamics::snake_energy(u, dynamics::SnakeEnergy::gradient);
  for (float& v : edges.values) v = std::min(1.0F, -4 * v);
  const field::VectorField gradient = dynamics::scaled_to_one(
      dynamics::force_of(dynamics::snake_energy(u, dynamics::SnakeEnergy::smoothed_gradient, 2)));
  field::VectorField flow = field::flow_field(edges, field::SteadyGvf{}).field;
  for (std::size_t n = 0; n < flow.x.size(); ++n)  // directions alone: the flow is weak far from the border
    if (const float length = std::hypot(flow.x[n], flow.y[n]); length > 0) flow.x[n] /= length, flow.y[n] /= length;

  const Contour start = circle_contour({31.5, 31}, 27, 1.5);
  dynamics::Snake options;
  options.alpha = 0.1;
  const Contour classic = dynamics::evolve_snake(start, gradient, options).contour;
  const Contour led = dynamics::evolve_snake(start, flow, options).contour;
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
  const std::vector<dynamics::Net> nets = dynamics::fit_topological_nets(plane, {});
  Drawing drawing;
  drawing.line({{0, 0}, {63, 0}, {63, 63}, {0, 63}, {0, 0}}, "silver");
  int holes = 0;
  for (const dynamics::Net& net : nets) {
    const dynamics::NetShape shape = dynamics::shape_of(net);
    holes += shape.holes;
    std::printf("net of %zu nodes: %d broken links, %d holes\n", net.nodes.size(), net.broken_links, shape.holes);
    for (const auto& q : net.quads)
      drawing.line({net.nodes[q[0]], net.nodes[q[1]], net.nodes[q[2]], net.nodes[q[3]], net.nodes[q[0]]}, "steelblue");
  }
  drawing.save("nets.svg");
  const dynamics::NetShape whole = dynamics::shape_of(dynamics::fit_net(plane, {}));
  std::printf("active net: %d part, %d holes\n", whole.parts, whole.holes);
  return nets.size() == 2 && holes == 1 && whole.parts == 1 && whole.holes == 0;
}

/// How far a contour strays from a circle, px, in a sector of the plane.
double stray_of(const Contour& c, const Vec2& centre, double radius, bool in_gap) {
  double worst = 0;
  for (const Vec2& p : c.points)
    if (const Vec2 d = p - centre; (d.x() > std::abs(d.y())) == in_gap)
      worst = std::max(worst, std::abs(d.norm() - radius));
  return worst;
}

bool show_stroke() {
  // A ring that is dark over a quarter of its way; the user draws along the missing part.
  const Vec2 centre(31.5, 31.5);
  constexpr double radius = 18;
  const Image ring = painted([&](const Vec2& p) {
    const Vec2 d = p - centre;
    return std::abs(d.norm() - radius) < 1.5 && d.x() <= std::abs(d.y());
  });
  const Image energy = dynamics::image_potential(ring, {dynamics::PotentialSource::bright, 1.5});
  Image helped = energy;
  dynamics::Stroke stroke;
  for (int n = -5; n <= 5; ++n) {
    const double angle = n * 3.14159265358979 / 20;
    stroke.points.push_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  dynamics::add_strokes(helped, std::span(&stroke, 1));
  dynamics::DiscreteContour options;
  options.internal = 0.1;
  const Contour start = circle_contour(centre, 22, 2);
  const Contour alone =
      dynamics::evolve_contour(start, dynamics::scaled_to_one(dynamics::force_of(energy)), options).contour;
  const Contour led =
      dynamics::evolve_contour(start, dynamics::scaled_to_one(dynamics::force_of(helped)), options).contour;
  const double without = stray_of(alone, centre, radius, true), with = stray_of(led, centre, radius, true);
  std::printf("contour in the gap of a ring: %.1f px off; along the user's stroke: %.1f px\n", without, with);
  Drawing drawing;
  draw(drawing, start, "gray");
  draw(drawing, alone, "crimson");
  draw(drawing, led, "seagreen");
  drawing.line(stroke.points, "silver");
  drawing.save("stroke.svg");
  return with < 1.5 && without > 1.5 * with;
}

}  // namespace

int main() {
  const bool snakes = show_snakes(), nets = show_nets(), stroke = show_stroke();
  return snakes && nets && stroke ? 0 : 1;
}
