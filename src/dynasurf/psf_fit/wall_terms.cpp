#include "dynasurf/psf_fit/detail/wall_terms.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/psf_fit/detail/harmonics.hpp"

namespace dynasurf::psf_fit {
namespace {

/// q of both walls along one direction, and the muscle per solid angle between them.
struct Ray {
  double endo = 0, epi = 0, muscle = 0;

  /// Derivatives of the outer wall's q by the logs of the inner wall's q and of the muscle, the latter times `scale`.
  double epi_by_endo() const { return endo * endo * endo / (epi * epi); }
  double epi_by_muscle(double scale) const { return scale * muscle / (3 * epi * epi); }
};
Ray ray_along(const GateLayout& layout, const Eigen::VectorXd& gate, const auto& harmonics) {
  const int endo = harmonics_up_to(layout.endo_degree), wall = harmonics_up_to(layout.wall_degree);
  const double q_endo = own::exp(harmonics.head(endo).dot(gate.segment(layout.endo, endo)));
  const double muscle = own::exp(harmonics.head(wall).dot(gate.segment(layout.wall, wall)));
  return {q_endo, own::cbrt(q_endo * q_endo * q_endo + muscle), muscle};
}

/// Adds derivatives by the logs of the inner wall's q and of the muscle along one direction.
void add_derivatives(const GateLayout& layout, const auto& harmonics, double by_endo, double by_muscle,
                     Eigen::VectorXd& by_number) {
  const int endo = harmonics_up_to(layout.endo_degree), wall = harmonics_up_to(layout.wall_degree);
  by_number.segment(layout.endo, endo) += by_endo * harmonics.head(endo).transpose();
  by_number.segment(layout.wall, wall) += by_muscle * harmonics.head(wall).transpose();
}

/// The mean of the log of the wall's thickness against its prior.
WallTerm thickness_term(const BeatProblem& problem, const Eigen::VectorXd& gate) {
  const ThicknessPrior& prior = problem.thickness;
  const GateLayout& layout = problem.layout.gate;
  WallTerm term{prior.gate, 0, Eigen::VectorXd::Zero(layout.count())};
  const double directions = prior.harmonics.rows();
  double sum = 0;
  for (Eigen::Index d = 0; d < prior.harmonics.rows(); ++d) {
    const auto row = prior.harmonics.row(d);
    const Ray ray = ray_along(layout, gate, row);
    const double thick = ray.epi - ray.endo;
    sum += own::log(thick * prior.mm_per_q[d] / prior.mean_mm);
    const double scale = 1 / (thick * prior.log_sd * directions);
    add_derivatives(layout, row, scale * (ray.epi_by_endo() - ray.endo), ray.epi_by_muscle(scale), term.by_number);
  }
  term.deviation = sum / (directions * prior.log_sd);
  return term;
}

/// The log of the reported wall's q against that of a point.
WallTerm point_term(const BeatProblem& problem, const PlacedPoint& point, const Eigen::VectorXd& gate) {
  const GateLayout& layout = problem.layout.gate;
  const ReportedWalls& reported = problem.reported;
  WallTerm term{point.gate, 0, Eigen::VectorXd::Zero(layout.count())};
  const Ray ray = ray_along(layout, gate, point.harmonics);
  // Cubes of q: the wall encloses the cavity and a share of the muscle.
  const double cavity =
      own::pow(ray.endo, 3) * (reported.outwards.empty() ? 1 : own::exp(3 * reported.outwards[point.gate]));
  const double share = point.is_outer ? 1 - reported.beyond : reported.cavity_share(point.gate);
  const double muscle = share * ray.muscle, whole = reported_cavity(cavity, ray.muscle, share);
  term.deviation = (own::log(whole) / 3 - point.log_q) / point.log_sd;
  add_derivatives(layout, point.harmonics, cavity / (whole * point.log_sd), muscle / (3 * whole * point.log_sd),
                  term.by_number);
  return term;
}

}  // namespace

std::vector<WallTerm> wall_terms(const BeatProblem& problem, const std::vector<Eigen::VectorXd>& gates) {
  std::vector<WallTerm> terms;
  if (problem.thickness.harmonics.rows() > 0) terms.push_back(thickness_term(problem, gates[problem.thickness.gate]));
  for (const PlacedPoint& point : problem.points) terms.push_back(point_term(problem, point, gates[point.gate]));
  return terms;
}

ThicknessPrior thickness_prior(const PlacedStart& start, int degree, const BlurFit& options) {
  constexpr int directions = 120;
  ThicknessPrior prior;
  if (options.thickness_mm) {
    prior.is_given = true;
    prior.mean_mm = *options.thickness_mm * (1 + options.papillary_share);
    prior.log_sd = options.thickness_uncertainty;
  }
  double largest = 0;
  for (std::size_t g = 0; g < start.endo.size(); ++g) {
    const double volume = mesh::volume_mm3(start.endo[g]);
    if (volume > largest) largest = volume, prior.gate = g;
  }
  const double base = start.frame.to_heart(start.base[prior.gate].point)[2];
  const double apex = -start.frame.scale[2], lowest = prior.is_given ? apex + (base - apex) / 3 : apex;
  std::vector<double> mm, harmonics(harmonics_up_to(degree));
  std::vector<std::vector<double>> rows;
  for (int n = 0; n < directions; ++n) {
    const Vec3 direction = fibonacci_direction(n, directions);
    const double height = direction[2] * start.frame.scale[2];
    if (height > 0.8 * base || height < lowest) continue;
    real_spherical_harmonics(direction, degree, harmonics);
    rows.push_back(harmonics);
    prior.directions.push_back(direction);
    mm.push_back(1 / direction.cwiseQuotient(start.frame.scale).norm());
  }
  prior.harmonics.resize(rows.size(), harmonics_up_to(degree));
  for (std::size_t n = 0; n < rows.size(); ++n)
    prior.harmonics.row(n) = Eigen::Map<Eigen::RowVectorXd>(rows[n].data(), harmonics_up_to(degree));
  prior.mm_per_q = Eigen::Map<Eigen::VectorXd>(mm.data(), mm.size());
  return prior;
}

void follow_slopes(const GateLayout& layout, const HeartFrame& frame, const Eigen::VectorXd& gate,
                   ThicknessPrior& prior) {
  constexpr double step = 1e-3;
  Eigen::RowVectorXd harmonics(prior.harmonics.cols());
  const int degree = std::max(layout.endo_degree, layout.wall_degree);
  const auto log_middle = [&](const Vec3& direction) {
    real_spherical_harmonics(direction.normalized(), degree, std::span(harmonics.data(), harmonics_up_to(degree)));
    const Ray ray = ray_along(layout, gate, harmonics);
    return own::log((ray.endo + ray.epi) / 2);
  };
  for (std::size_t d = 0; d < prior.directions.size(); ++d) {
    const Vec3& direction = prior.directions[d];
    const Vec3 along = direction.unitOrthogonal(), across = direction.cross(along);
    Vec3 normal = direction;
    for (const Vec3& t : {along, across})
      normal -= (log_middle(direction + step * t) - log_middle(direction - step * t)) / (2 * step) * t;
    prior.mm_per_q[d] = 1 / normal.cwiseQuotient(frame.scale).norm();
  }
}

std::vector<PlacedPoint> placed_points(const PlacedStart& start, int degree) {
  constexpr double sd_mm = 0.15;                 // a person is believed more than the image there
  constexpr double nearest = 0.2, farthest = 3;  // in sizes of the heart
  std::vector<PlacedPoint> points;
  std::vector<double> harmonics(harmonics_up_to(degree));
  for (const WallPoint& placed : start.points) {
    const Vec3 heart = start.frame.to_heart(placed.place), scaled = heart.cwiseQuotient(start.frame.scale);
    const double q = scaled.norm();
    if (!(q > nearest && q < farthest)) {
      char text[200];
      std::snprintf(text, sizeof text,
                    "a point placed on the %s wall of gate %d lies %.0f mm from the middle of the heart; expected a "
                    "place on that wall",
                    placed.is_outer ? "outer" : "inner", placed.gate + 1, heart.norm());
      throw OptionError(text);
    }
    real_spherical_harmonics(scaled / q, degree, harmonics);
    points.push_back({Eigen::Map<const Eigen::RowVectorXd>(harmonics.data(), harmonics_up_to(degree)), placed.gate,
                      placed.is_outer, own::log(q), sd_mm / heart.norm()});
  }
  return points;
}

}  // namespace dynasurf::psf_fit
