#include "dynasurf/psf_fit/detail/start.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/image/intensity.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/psf_fit/detail/cholesky.hpp"
#include "dynasurf/psf_fit/detail/harmonics.hpp"

namespace dynasurf::psf_fit {
namespace {

Vec3 middle_of(const TriMesh& mesh) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : mesh.vertices) sum += p;
  return sum / std::max<double>(1, mesh.vertices.size());
}

double lowest(const TriMesh& mesh, const Vec3& axis) {
  double low = std::numeric_limits<double>::infinity();
  for (const Vec3& p : mesh.vertices) low = std::min(low, p.dot(axis));
  return low;
}

double highest(const TriMesh& mesh, const Vec3& axis) { return -lowest(mesh, -axis); }

/// The ellipsoid `outside_mm` beyond the cup, closed.
TriMesh shell_of(const heart::LvShell& cup, double outside_mm) {
  constexpr int level = 3;
  const heart::ShellBasis a = heart::across(cup.axis);
  TriMesh mesh = mesh::icosphere(level);
  for (Vec3& p : mesh.vertices)
    p = cup.centre + (cup.radius_mm + outside_mm) * (p[0] * a.u + p[1] * a.v) +
        (cup.half_length_mm + outside_mm) * p[2] * cup.axis;
  return mesh;
}

/// Distance from the axis of the points around a height, in the mean.
double radius_at(const TriMesh& mesh, const Vec3& axis, const Vec3& centre, double within_mm) {
  double sum = 0, count = 0;
  for (const Vec3& p : mesh.vertices) {
    const Vec3 d = p - centre;
    const double height = d.dot(axis);
    if (std::abs(height) > within_mm) continue;
    sum += (d - height * axis).norm(), count += 1;
  }
  return count > 0 ? sum / count : 0;
}

}  // namespace

PlacedStart place_start(const FitStart& given, const Grid& grid) {
  FitStart start = given;
  if (start.cup) {
    constexpr double half_wall_mm = 5;
    const double inside = std::min(half_wall_mm, 0.5 * start.cup->radius_mm);
    std::fill(start.endo.begin(), start.endo.end(), shell_of(*start.cup, -inside));
    std::fill(start.epi.begin(), start.epi.end(), shell_of(*start.cup, half_wall_mm));
    for (auto& base : start.base)
      if (!base) base = heart::BasePlane{.point = start.cup->base(), .normal = start.cup->axis};
    start.axis = start.cup->axis;
  }
  PlacedStart placed;
  placed.looked_at = start.looked_at;
  placed.points = start.points;
  for (WallPoint& point : placed.points) point.place = to_grid(grid, point.place);
  Vec3 axis = start.axis.normalized();
  Vec3 normals = Vec3::Zero();
  for (const auto& base : start.base)
    if (base) normals += base->normal;
  // The mean normal of the valve planes is the axis, unless it leans from the given one by more than 26 degrees.
  if (normals.norm() > 0.5 && normals.normalized().dot(axis) > 0.9) axis = normals.normalized();
  const Vec3 z = grid.direction.transpose() * axis;
  Vec3 x = grid.direction.transpose() * start.lateral;
  x = (x - x.dot(z) * z).normalized();
  placed.frame.axes.col(0) = x;
  placed.frame.axes.col(1) = z.cross(x);
  placed.frame.axes.col(2) = z;

  // The centre lies in the cavity of every gate: halfway between the highest apex and the lowest base.
  double apex = -std::numeric_limits<double>::infinity(), base = -apex;
  const double gates = start.endo.size();
  Vec3 middle = Vec3::Zero();
  for (std::size_t g = 0; g < start.endo.size(); ++g) {
    placed.endo.push_back(to_grid(grid, start.endo[g]));
    placed.epi.push_back(to_grid(grid, start.epi[g]));
    const TriMesh &endo = placed.endo.back(), &epi = placed.epi.back();
    middle += middle_of(endo) / gates;
    const bool has_plane = start.base[g].has_value();
    heart::BasePlane plane = has_plane ? to_grid(grid, *start.base[g]) : heart::BasePlane{};
    if (!has_plane) {
      plane.normal = z;
      plane.point = middle_of(endo) + (0.5 * (highest(endo, z) + highest(epi, z)) - middle_of(endo).dot(z)) * z;
    }
    placed.base.push_back(plane);
    apex = std::max(apex, lowest(endo, z));
    base = std::min(base, plane.point.dot(z));
  }
  placed.frame.centre = middle + (0.5 * apex + 0.5 * base - middle.dot(z)) * z;
  double radius = 0, length = 0;
  for (std::size_t g = 0; g < placed.endo.size(); ++g)
    for (const TriMesh* mesh : {&placed.endo[g], &placed.epi[g]}) {
      const double share = 0.5 / placed.endo.size();
      radius += share * radius_at(*mesh, z, placed.frame.centre, 10);
      length += share * (placed.frame.centre.dot(z) - lowest(*mesh, z));
    }
  placed.frame.scale = {std::max(radius, 5.0), std::max(radius, 5.0), std::clamp(length, radius, 2.5 * radius)};
  return placed;
}

Eigen::VectorXd smooth_harmonics(const Eigen::MatrixXd& rows, const Eigen::VectorXd& values, int degree) {
  constexpr double noise = 0.05;
  Eigen::MatrixXd matrix = product(rows.transpose(), rows) / std::max<double>(1, rows.rows()) * 300;
  for (int k = 0; k < harmonics_up_to(degree); ++k) {
    const int l = degree_of_harmonic(k);
    const double sd = l == 0 ? 2.0 : 0.5 * own::pow(l, -2.0);
    matrix(k, k) += noise * noise / (sd * sd);
  }
  // As if there were 300 directions, however many there are: the prior weighs the same in every fit.
  const double scale = 300.0 / std::max<Eigen::Index>(1, rows.rows());
  return Cholesky(matrix).solve(rows.transpose() * values * scale);
}

Eigen::VectorXd harmonics_of_surface(const TriMesh& surface, const HeartFrame& frame, const heart::BasePlane& base,
                                     int degree) {
  constexpr double lid_mm = 2.5;
  const int count = harmonics_up_to(degree);
  Eigen::MatrixXd rows(surface.vertices.size(), count);
  Eigen::VectorXd values(rows.rows());
  Eigen::Index used = 0;
  std::vector<double> harmonics(count);
  for (const Vec3& p : surface.vertices) {
    if (base.height(p) > -lid_mm) continue;
    const Vec3 scaled = frame.to_heart(p).cwiseQuotient(frame.scale);
    if (scaled.norm() < 0.02) continue;
    real_spherical_harmonics(scaled.normalized(), degree, harmonics);
    rows.row(used) = Eigen::Map<Eigen::RowVectorXd>(harmonics.data(), count);
    values[used++] = own::log(scaled.norm());
  }
  return smooth_harmonics(rows.topRows(used), values.head(used), degree);
}

Eigen::VectorXd uptake_seen(const Image& mean, const PlacedStart& start, double healthy, int degree) {
  constexpr int directions = 400, shape_degree = 4, fewest = 50;
  constexpr double faintest = 0.08, brightest = 1.3;  // of healthy muscle
  constexpr double telling = 0.5;                     // log; smaller differences are thickness and blur
  constexpr double below_base_mm = 4;
  const Eigen::VectorXd endo = harmonics_of_surface(start.endo.front(), start.frame, start.base.front(), shape_degree);
  const Eigen::VectorXd epi = harmonics_of_surface(start.epi.front(), start.frame, start.base.front(), shape_degree);
  double base = std::numeric_limits<double>::infinity();
  for (const heart::BasePlane& plane : start.base) base = std::min(base, start.frame.to_heart(plane.point)[2]);
  std::vector<double> harmonics(harmonics_up_to(std::max(degree, shape_degree)));
  Eigen::MatrixXd rows(directions, harmonics_up_to(degree));
  Eigen::VectorXd values(directions);
  Eigen::Index used = 0;
  for (int n = 0; n < directions; ++n) {
    const Vec3 direction = fibonacci_direction(n, directions);
    real_spherical_harmonics(direction, std::max(degree, shape_degree), harmonics);
    const Eigen::Map<const Eigen::VectorXd> at(harmonics.data(), harmonics.size());
    const double inner = own::exp(endo.dot(at.head(endo.size()))), outer = own::exp(epi.dot(at.head(epi.size())));
    if (direction[2] * start.frame.scale[2] * (inner + outer) / 2 > base - below_base_mm) continue;
    double most = 0;
    for (int step = -2; step <= 10; ++step) {  // from a quarter of the wall's thickness inside it to as much outside
      const double q = inner + (outer - inner) * step / 8;
      most = std::max(
          most, image::sample_linear(mean, start.frame.from_heart((q * direction).cwiseProduct(start.frame.scale))));
    }
    const double seen = own::log(std::clamp(most / healthy, faintest, brightest));
    rows.row(used) = at.head(rows.cols()).transpose();
    values[used++] = seen * seen * seen / (seen * seen + telling * telling);
  }
  if (used < fewest) return Eigen::VectorXd::Zero(rows.cols());
  return smooth_harmonics(rows.topRows(used), values.head(used), degree);
}

std::vector<Eigen::VectorXd> first_numbers(const PlacedStart& start, const GateLayout& layout, double background,
                                           double cavity) {
  constexpr int directions = 300;
  std::vector<Eigen::VectorXd> numbers;
  const int most = std::max(layout.endo_degree, layout.wall_degree);
  std::vector<double> harmonics(harmonics_up_to(most));
  Eigen::MatrixXd rows(directions, harmonics_up_to(most));
  for (int n = 0; n < directions; ++n) {
    real_spherical_harmonics(fibonacci_direction(n, directions), most, harmonics);
    rows.row(n) = Eigen::Map<Eigen::RowVectorXd>(harmonics.data(), rows.cols());
  }
  for (std::size_t g = 0; g < start.endo.size(); ++g) {
    Eigen::VectorXd gate = Eigen::VectorXd::Zero(layout.count());
    const Eigen::VectorXd endo = harmonics_of_surface(start.endo[g], start.frame, start.base[g], most);
    const Eigen::VectorXd epi = harmonics_of_surface(start.epi[g], start.frame, start.base[g], most);
    const Eigen::ArrayXd inner = (rows * endo).array().unaryExpr(&own::exp).cube();
    const Eigen::ArrayXd outer = (rows * epi).array().unaryExpr(&own::exp).cube();
    // The number of the wall is the log of its part of q^3, so that no number makes it thinner than nothing. Where the
    // walls of a start touch or cross, it gets 0.15 of what the outer one encloses.
    const Eigen::VectorXd muscle = (outer - inner).max(0.15 * outer).unaryExpr(&own::log).matrix();
    gate.segment(layout.endo, harmonics_up_to(layout.endo_degree)) = endo.head(harmonics_up_to(layout.endo_degree));
    gate.segment(layout.wall, harmonics_up_to(layout.wall_degree)) =
        smooth_harmonics(rows.leftCols(harmonics_up_to(layout.wall_degree)), muscle, layout.wall_degree);
    gate[layout.uptake] = 0;
    const HeartFrame& frame = start.frame;
    const Vec3 normal = frame.axes.transpose() * start.base[g].normal, point = frame.to_heart(start.base[g].point);
    // The plane as a height over x and y.
    gate[layout.plane + 1] = -normal[0] / normal[2];
    gate[layout.plane + 2] = -normal[1] / normal[2];
    gate[layout.plane] = point[2] - gate[layout.plane + 1] * point[0] - gate[layout.plane + 2] * point[1];
    gate[layout.cavity] = cavity;
    gate[layout.background] = background;
    numbers.push_back(std::move(gate));
  }
  return numbers;
}

}  // namespace dynasurf::psf_fit
