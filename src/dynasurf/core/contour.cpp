#include "dynasurf/core/contour.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf {
namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// A place on a contour: an edge and the share of it that lies behind.
struct Place {
  std::size_t edge = 0;
  double share = 0;
};

std::optional<Place> crossing_with_ray(const Contour& c, const Vec2& centre) {
  std::optional<Place> farthest;
  double far = 0;
  for (std::size_t e = 0; e < c.edges(); ++e) {
    const Vec2 a = c.points[e] - centre, b = c.end_of_edge(e) - centre;
    // A point on the ray counts to one side alone, so that it is crossed once by the two edges that it joins.
    if ((a.y() < 0) == (b.y() < 0)) continue;
    const double share = a.y() / (a.y() - b.y());
    const double x = a.x() + share * (b.x() - a.x());
    if (x >= far) far = x, farthest = Place{e, share};
  }
  return farthest;
}

Place place_nearest_to_axis(const Contour& c, const Vec2& centre) {
  Place best;
  double least = 10;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const Vec2 d = c.points[i] - centre;
    const double angle = std::abs(own::atan2(d.y(), d.x()));
    if (angle < least) least = angle, best = Place{i, 0};
  }
  return best;
}

}  // namespace

double signed_area(const Contour& c) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < c.size(); ++i)
    twice += cross(c.points[i] - c.points[0], c.points[i + 1] - c.points[0]);
  return twice / 2;
}

double length_of(const Contour& c) {
  double length = 0;
  for (std::size_t e = 0; e < c.edges(); ++e) length += (c.end_of_edge(e) - c.points[e]).norm();
  return length;
}

Vec2 centroid_of(const Contour& c) {
  // Seen from a point of the contour: far from the origin the products would cancel out.
  const Vec2& origin = c.points[0];
  double twice = 0;
  Vec2 sum = Vec2::Zero(), mean = Vec2::Zero();
  for (std::size_t i = 1; i + 1 < c.size(); ++i) {
    const Vec2 a = c.points[i] - origin, b = c.points[i + 1] - origin;
    const double w = cross(a, b);
    twice += w;
    sum += w * (a + b) / 3;
  }
  const double length = length_of(c);
  if (std::abs(twice) > 1e-12 * length * length) return origin + sum / twice;
  const double count = c.size();
  for (const Vec2& p : c.points) mean += p / count;
  return mean;
}

bool encloses(const Contour& c, const Vec2& p) {
  bool inside = false;
  for (std::size_t e = 0; e < c.edges(); ++e) {
    const Vec2 a = c.points[e] - p, b = c.end_of_edge(e) - p;
    if ((a.y() > 0) != (b.y() > 0) && a.x() + a.y() / (a.y() - b.y()) * (b.x() - a.x()) > 0) inside = !inside;
  }
  return inside;
}

Contour circle_contour(const Vec2& centre, double radius, double edge) {
  if (!(radius > 0) || !(edge > 0) || !std::isfinite(radius / edge))
    throw OptionError("circle_contour: radius " + std::to_string(radius) + ", edge " + std::to_string(edge) +
                      "; expected positive numbers");
  const int n = std::max(6, round_int(2 * std::numbers::pi * radius / edge));
  Contour c;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    c.points.push_back(centre + radius * Vec2(own::cos(angle), own::sin(angle)));
  }
  return c;
}

Contour spread_evenly(const Contour& original, int count, const Vec2& centre) {
  const double length = length_of(original);
  if (!original.closed || original.size() < 3 || !(length > 0) || !std::isfinite(length))
    throw InputError("spread_evenly: a contour of " + std::to_string(original.size()) +
                     " points; expected a closed one with a length");
  if (count < 3) throw OptionError("spread_evenly: count is " + std::to_string(count) + "; expected 3 or more");
  Contour c = original;
  if (signed_area(c) < 0) std::reverse(c.points.begin(), c.points.end());
  const auto crossing = crossing_with_ray(c, centre);
  const Place start = crossing ? *crossing : place_nearest_to_axis(c, centre);

  Contour even;
  std::size_t edge = start.edge;
  Vec2 at = c.points[edge] + start.share * (c.end_of_edge(edge) - c.points[edge]);
  double left = (c.end_of_edge(edge) - at).norm();  // of the current edge
  even.points.push_back(at);
  for (int i = 1; i < count; ++i) {
    double way = length / count;
    while (way > left) {
      way -= left;
      edge = (edge + 1) % c.edges();
      at = c.points[edge];
      left = (c.end_of_edge(edge) - at).norm();
    }
    if (left > 0) at += (way / left) * (c.end_of_edge(edge) - at);
    left -= way;
    even.points.push_back(at);
  }
  return even;
}

}  // namespace dynasurf
