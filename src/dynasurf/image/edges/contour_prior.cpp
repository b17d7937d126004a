#include "dynasurf/image/edges/detail/contour_prior.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/QR>

namespace dynasurf::image {
namespace {

constexpr std::array<std::string_view, 3> names{"none", "circle", "ellipse"};
constexpr std::size_t least_pixels = 10;    // of all contours
constexpr std::size_t least_contour = 4;    // shorter ones say little, and each costs an unknown
constexpr double roundest_to_flattest = 9;  // square of the ratio of axes beyond which a fit is no border of a wall

/// Pixels about an origin near them, with the number of their contour.
struct Points {
  std::vector<Eigen::Vector2d> at;
  std::vector<Eigen::Index> contour;
  Eigen::Index contours = 0;
};

Points points_of(std::span<const Component> contours, const Eigen::Vector2d& origin) {
  Points points;
  for (const Component& c : contours) {
    if (c.pixels.size() < least_contour) continue;
    for (const Pixel& p : c.pixels) {
      points.at.push_back(Eigen::Vector2d(p.i, p.j) - origin);
      points.contour.push_back(points.contours);
    }
    ++points.contours;
  }
  return points;
}

Eigen::Vector2d mean_place(std::span<const Component> contours) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double count = 0;
  for (const Component& c : contours)
    for (const Pixel& p : c.pixels) sum += Eigen::Vector2d(p.i, p.j), count += 1;
  return count > 0 ? Eigen::Vector2d(sum / count) : sum;
}

/// The conic in the coordinates of the slice.
Conic moved(const Conic& q, const Eigen::Vector2d& origin) {
  return {q.a, q.b, q.c, q.d - 2 * q.a * origin[0] - q.b * origin[1], q.e - q.b * origin[0] - 2 * q.c * origin[1]};
}

bool is_round(const Conic& q) {
  const double product = q.a * q.c - q.b * q.b / 4, half_sum = (q.a + q.c) / 2;
  if (!(product > 0 && half_sum > 0)) return false;
  const double difference = std::sqrt(std::max(0.0, half_sum * half_sum - product));
  return half_sum + difference < roundest_to_flattest * (half_sum - difference);
}

/// Least squares of the conic with a + c = 2; of a circle a = c and b = 0. About a fixed middle there is no d and e.
std::optional<Conic> fit(const Points& points, bool ellipse, bool fixed) {
  const Eigen::Index shape = ellipse ? 2 : 0, place = fixed ? 0 : 2, unknowns = shape + place + points.contours;
  const Eigen::Index rows = points.at.size();
  if (rows < unknowns) return std::nullopt;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(rows, unknowns);
  Eigen::VectorXd right(rows);
  for (Eigen::Index r = 0; r < rows; ++r) {
    const double x = points.at[r][0], y = points.at[r][1];
    // (1 + p) x^2 + b x y + (1 - p) y^2 + d x + e y - f = 0
    if (ellipse) matrix(r, 0) = x * x - y * y, matrix(r, 1) = x * y;
    if (!fixed) matrix(r, shape) = x, matrix(r, shape + 1) = y;
    matrix(r, shape + place + points.contour[r]) = -1;
    right[r] = -(x * x + y * y);
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(matrix);
  if (solver.rank() < unknowns) return std::nullopt;
  const Eigen::VectorXd found = solver.solve(right);
  Conic q;
  if (ellipse) q.a = 1 + found[0], q.b = found[1], q.c = 1 - found[0];
  if (!fixed) q.d = found[shape], q.e = found[shape + 1];
  return is_round(q) ? std::optional(q) : std::nullopt;
}

}  // namespace

std::span<const std::string_view> names_of(ContourPrior) { return names; }

Eigen::Vector2d Conic::middle() const {
  const double determinant = 4 * a * c - b * b;
  return {(b * e - 2 * c * d) / determinant, (b * d - 2 * a * e) / determinant};
}

std::optional<Conic> fit_conics(std::span<const Component> contours, const ContourCompletion& o) {
  const bool fixed = o.prior_x_px && o.prior_y_px;
  const Eigen::Vector2d origin = fixed ? Eigen::Vector2d(*o.prior_x_px, *o.prior_y_px) : mean_place(contours);
  const Points points = points_of(contours, origin);
  if (o.prior == ContourPrior::circle && fixed) return moved({}, origin);
  if (points.at.size() < least_pixels) return std::nullopt;
  std::optional<Conic> found;
  if (o.prior == ContourPrior::ellipse) found = fit(points, true, fixed);
  if (!found) found = fit(points, false, fixed);
  return found ? std::optional(moved(*found, origin)) : std::nullopt;
}

}  // namespace dynasurf::image
