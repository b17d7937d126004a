#pragma once
#include <optional>
#include <span>

#include <Eigen/Core>

#include "dynasurf/image/detail/components.hpp"
#include "dynasurf/image/edges.hpp"

namespace dynasurf::image {

/// The family a x^2 + b x y + c y^2 + d x + e y = constant of a circle or an ellipse and its enlargements, in pixels.
struct Conic {
  double a = 1, b = 0, c = 1, d = 0, e = 0;
  double level(double x, double y) const { return x * (a * x + b * y + d) + y * (c * y + e); }
  /// Square to the member of the family that runs through a place; zero in the middle.
  Eigen::Vector2d slope(double x, double y) const { return {2 * a * x + b * y + d, b * x + 2 * c * y + e}; }
  Eigen::Vector2d middle() const;
};

/// The circles, or the ellipses of one shape, about one middle that lie nearest to the contours of a slice, each
/// contour on a member of its own: linear least squares, so torn contours of several walls are fitted together. Circles
/// where the contours are no ellipses. Absent where they are too few (10 pixels) or all on a line. The middle is
/// that of `options` where it is set.
std::optional<Conic> fit_conics(std::span<const Component> contours, const ContourCompletion& options);

}  // namespace dynasurf::image
