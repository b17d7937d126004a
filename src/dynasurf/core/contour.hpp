#pragma once
#include <vector>

#include <Eigen/Core>

#include "dynasurf/core/grid.hpp"

namespace dynasurf {

/// A point or vector of a plane.
using Vec2 = Eigen::Vector2d;

/// A polygon in an image plane: points in the order in which they are joined, columns and rows in px unless said
/// otherwise. A closed contour does not repeat its first point.
struct Contour {
  std::vector<Vec2> points;
  bool closed = true;

  std::size_t size() const { return points.size(); }
  std::size_t edges() const { return points.size() < 2 ? 0 : closed ? points.size() : points.size() - 1; }
  /// Edge e runs from point e to this one.
  const Vec2& end_of_edge(std::size_t e) const { return points[e + 1 == points.size() ? 0 : e + 1]; }
};

/// Area by Green's theorem about the first point; positive when x turns to y (counter-clockwise with y upwards).
double signed_area(const Contour& contour);
double length_of(const Contour& contour);
/// Centroid of the enclosed area; the mean of the points where there is no area. Precondition: not empty.
Vec2 centroid_of(const Contour& contour);
/// Inside a closed contour, by the parity of crossings.
bool encloses(const Contour& contour, const Vec2& point);

/// Regular polygon around a centre, counter-clockwise, edges of about `edge` and at least 6 of them.
/// Throws OptionError unless radius and edge are positive.
Contour circle_contour(const Vec2& centre, double radius, double edge);

/// `count` points at equal arc length along a closed contour, counter-clockwise. The first lies where the ray from
/// `centre` in the direction of +x leaves the contour (the farthest crossing); where the ray misses it, at the point
/// whose direction from `centre` is nearest to +x. Throws InputError unless the contour is closed with 3 points or
/// more and a length, OptionError for a count below 3.
Contour spread_evenly(const Contour& contour, int count, const Vec2& centre);

}  // namespace dynasurf
