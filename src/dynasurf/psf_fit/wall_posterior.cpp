#include "dynasurf/psf_fit/detail/wall_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/psf_fit/detail/harmonics.hpp"
#include "dynasurf/psf_fit/detail/wall_terms.hpp"

namespace dynasurf::psf_fit {
namespace {

/// The walls along the rays through some points; rows of absent points are 0.
struct Rays {
  Eigen::MatrixXd harmonics;
  Eigen::VectorXd mm;                        // from the centre to the point
  Eigen::VectorXd epi_by_endo, epi_by_wall;  // derivatives of log q_epi by log q_endo and by log of the muscle
};

/// `degree`: of the harmonics that are wanted, not below that of the walls.
Rays rays_through(const std::vector<std::optional<Vec3>>& points, const HeartFrame& frame, const Grid& grid,
                  const GateLayout& layout, const Eigen::VectorXd& gate, int degree) {
  constexpr std::size_t rays_at_once = 64;
  const int endo = harmonics_up_to(layout.endo_degree), wall = harmonics_up_to(layout.wall_degree);
  const Eigen::Index count = points.size();
  Rays rays{Eigen::MatrixXd::Zero(count, harmonics_up_to(degree)), Eigen::VectorXd::Zero(count),
            Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count)};
  parallel_for(points.size(), rays_at_once, [&](std::size_t begin, std::size_t end) {
    std::vector<double> harmonics(harmonics_up_to(degree));
    for (std::size_t p = begin; p < end; ++p) {
      const auto& point = points[p];
      if (!point) continue;
      const Vec3 heart = frame.to_heart(to_grid(grid, *point));
      real_spherical_harmonics(heart.cwiseQuotient(frame.scale).normalized(), degree, harmonics);
      rays.harmonics.row(p) = Eigen::Map<const Eigen::RowVectorXd>(harmonics.data(), rays.harmonics.cols());
      rays.mm[p] = heart.norm();
      const double inner = own::exp(3 * rays.harmonics.row(p).head(endo).dot(gate.segment(layout.endo, endo)));
      const double muscle = own::exp(rays.harmonics.row(p).head(wall).dot(gate.segment(layout.wall, wall)));
      rays.epi_by_endo[p] = inner / (inner + muscle), rays.epi_by_wall[p] = muscle / (3 * (inner + muscle));
    }
  });
  return rays;
}

double share_of_data(double left, double believed) {
  return std::clamp(1 - left * left / (believed * believed), 0.0, 1.0);
}

std::string in_percent(const char* pattern, double share) {
  char text[200];
  std::snprintf(text, sizeof text, pattern, 100 * share);
  return text;
}

/// A wall much thinner than the blur looks like a thicker, paler one, more so than small changes around the best fit
/// tell: the covariance does not know it. Half of all hearts at clinical widths are below `resolved` and read right;
/// it is doubtful below `lost` (both chosen on patients 0 to 31 of experiments/unbiased_200).
void tell_thin_wall(const BeatProblem& problem, const Solution& solution, FittedBeat& beat) {
  constexpr double resolved = 0.65, lost = 0.5;  // of the full width at half maximum
  constexpr double fwhm_of_sigma = 2.3548200450309493;
  const double width = problem.layout.at_gate(0, solution.unknowns)[problem.layout.gate.width];
  const double fwhm_mm = fwhm_of_sigma * problem.sigma_mm * own::exp(width);
  if (beat.thickness_mm.value >= resolved * fwhm_mm) return;
  char text[280];
  std::snprintf(
      text, sizeof text,
      "the wall (%.1f mm) is thin against the blur (%.1f mm): thickness, mass and volumes lean on what is "
      "believed of hearts (10 mm), and a thinner wall would look much the same; fit.thickness_mm takes a measured one",
      beat.thickness_mm.value, fwhm_mm);
  const bool is_lost = beat.thickness_mm.value < lost * fwhm_mm;
  beat.notes.push_back({is_lost ? Severity::warning : Severity::info, "fit.thin_wall", text});
}

/// What became of a thickness that a person gave.
void tell_given_thickness(const BeatProblem& problem, const WallTerm& fitted, FittedBeat& beat) {
  constexpr double contradicted = 3;  // standard deviations; right ones within a tenth are off by 2.4 at most
  const ThicknessPrior& given = problem.thickness;
  const double off = given.log_sd * fitted.deviation + own::log(1 - problem.reported.beyond);
  const double given_percent = 100 * given.log_sd;
  const double off_percent = std::round(100 * own::expm1(off)) + 0.0;  // no -0
  char text[240];
  if (std::abs(off) > contradicted * given.log_sd) {
    std::snprintf(
        text, sizeof text,
        "the image contradicts the wall's thickness that was given with an uncertainty of %.0f %%: the fitted wall is "
        "%+.0f %% off it; check its unit, and that it is of end-diastole",
        given_percent, off_percent);
    beat.notes.push_back({Severity::warning, "fit.thickness_contradicted", text});
  } else {
    std::snprintf(text, sizeof text,
                  "the wall's thickness was given with an uncertainty of %.0f %%; the fitted wall is %+.0f %% off it",
                  given_percent, off_percent);
    beat.notes.push_back({Severity::info, "fit.thickness_given", text});
  }
}

}  // namespace

WallPosterior::WallPosterior(const BeatProblem& problem, const Eigen::VectorXd& unknowns, const Grid& grid,
                             const Cholesky& factor)
    : layout_(problem.layout),
      frame_(problem.cells.frame),
      grid_(grid),
      gates_(layout_.at_gates(unknowns)),
      factor_(factor) {}

Eigen::MatrixXd WallPosterior::no_gradient(Eigen::Index numbers) const {
  return Eigen::MatrixXd::Zero(layout_.unknowns, numbers);
}

void WallPosterior::add(int gate, const WallPoints& points, const WallDependence& dependence,
                        Eigen::MatrixXd& gradient) const {
  const GateLayout& layout = layout_.gate;
  const Eigen::VectorXd& numbers = gates_[gate];
  const int endo = harmonics_up_to(layout.endo_degree), wall = harmonics_up_to(layout.wall_degree);
  const int uptake = harmonics_up_to(layout.uptake_degree);
  const int of_walls = std::max(layout.endo_degree, layout.wall_degree);
  Eigen::MatrixXd of_gate = Eigen::MatrixXd::Zero(layout.count(), gradient.cols());
  if (dependence.by_endo.cols() > 0 || dependence.by_log_uptake.cols() > 0) {
    const int degree = dependence.by_log_uptake.cols() > 0 ? std::max(of_walls, layout.uptake_degree) : of_walls;
    const Rays inner = rays_through(points.endo, frame_, grid_, layout, numbers, degree);
    if (dependence.by_endo.cols() > 0)
      of_gate.middleRows(layout.endo, endo) +=
          product(inner.harmonics.leftCols(endo).transpose(), inner.mm.asDiagonal() * dependence.by_endo);
    if (dependence.by_log_uptake.cols() > 0)
      of_gate.middleRows(layout.uptake, uptake) +=
          product(inner.harmonics.leftCols(uptake).transpose(), dependence.by_log_uptake);
  }
  if (dependence.by_epi.cols() > 0) {
    const Rays outer = rays_through(points.epi, frame_, grid_, layout, numbers, of_walls);
    const Eigen::MatrixXd by_log = outer.mm.asDiagonal() * dependence.by_epi;
    of_gate.middleRows(layout.endo, endo) +=
        product(outer.harmonics.leftCols(endo).transpose(), outer.epi_by_endo.asDiagonal() * by_log);
    of_gate.middleRows(layout.wall, wall) +=
        product(outer.harmonics.leftCols(wall).transpose(), outer.epi_by_wall.asDiagonal() * by_log);
  }
  const auto& terms = layout_.terms[gate];
  for (Eigen::Index i = 0; i < of_gate.rows(); ++i)
    for (const BeatLayout::Term& t : terms[i]) gradient.row(t.unknown) += t.factor * of_gate.row(i);
}

Eigen::VectorXd WallPosterior::sd(const Eigen::MatrixXd& gradient) const { return factor_.half_norms(gradient); }

void tell_belief_from_data(const BeatProblem& problem, const Solution& solution, const Cholesky& factor,
                           FittedBeat& beat) {
  constexpr double least = 0.5;
  const ThicknessPrior& prior = problem.thickness;
  if (!prior.is_given) tell_thin_wall(problem, solution, beat);
  if (prior.harmonics.rows() > 0) {
    const WallTerm fitted = wall_terms(problem, problem.layout.at_gates(solution.unknowns)).front();
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(problem.layout.unknowns);
    problem.layout.add_gradient(prior.gate, fitted.by_number, gradient);
    const double share = share_of_data(factor.half_norm(gradient), 1);
    beat.thickness_from_data = share;
    if (prior.is_given)
      tell_given_thickness(problem, fitted, beat);
    else if (share < least)
      beat.notes.push_back(
          {Severity::warning, "fit.thickness_believed",
           in_percent("the data tell only %.0f %% of the wall's thickness, for the wall is thin against "
                      "the blur; the rest is what is believed of hearts (10 mm)",
                      share)});
  }
  const auto& width = problem.layout.terms[0][problem.layout.gate.width];
  if (width.empty()) return;  // exact
  const int unknown = width.front().unknown;
  const double share = share_of_data(factor.half_norm(Eigen::VectorXd::Unit(problem.layout.unknowns, unknown)),
                                     problem.layout.spread[unknown]);
  beat.width_from_data = share;
  if (share < least)
    beat.notes.push_back(
        {Severity::info, "fit.width_believed",
         in_percent("the data tell only %.0f %% of the width of the point spread; the rest is what was "
                    "given or believed of it",
                    share)});
}

}  // namespace dynasurf::psf_fit
