#include "dynasurf/psf_fit/detail/papillary_share.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/psf_fit/detail/harmonics.hpp"

namespace dynasurf::psf_fit {
namespace {

// Waves around the axis: one is a wall off the centre, two an oval one. Neither is a bulge.
constexpr int least_waves = 3;

/// Whether harmonic `k` has that many waves around the axis.
bool is_bulge(int k) {
  const int l = degree_of_harmonic(k);
  return std::abs(k - l * l - l) >= least_waves;
}

/// Sum of the squares of the bulges' harmonics, of a density over directions that has a mean of 1 over the sphere and
/// lies in two columns along the middle of the wall, at any angle from each other.
double bulge_of_columns(int degree) {
  constexpr int points = 16;
  constexpr double first = 50 * M_PI / 180, last = 105 * M_PI / 180;  // from the apex
  std::vector<double> at(harmonics_up_to(degree));
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(harmonics_up_to(degree));
  for (int n = 0; n < points; ++n) {
    const double from_apex = first + (last - first) * (n + 0.5) / points;
    real_spherical_harmonics({own::sin(from_apex), 0, -own::cos(from_apex)}, degree, at);
    mean += Eigen::Map<const Eigen::VectorXd>(at.data(), mean.size()) / points;
  }
  double sum = 0;
  for (int k = 0; k < mean.size(); ++k)
    if (is_bulge(k)) sum += 0.5 * mean[k] * mean[k];  // half in either column
  return sum;
}

}  // namespace

double papillary_share(const BeatProblem& problem, const Solution& solution, const Cholesky& factor, double usual) {
  const BeatLayout& layout = problem.layout;
  const GateLayout& places = layout.gate;
  if (usual <= 0) return usual;
  double muscle = 0, log_q = 0;
  for (int g = 0; g < layout.gates; ++g) {
    muscle += solution.objective.activity[g].wall_mm3 / layout.gates;
    log_q += layout.at_gate(g, solution.unknowns)[places.endo] / layout.gates;
  }
  // A cavity per solid angle of q^3 / 3 that loses the columns' volume.
  const double volume = muscle / problem.cells.frame.scale.prod();
  const double log_q_by_share = volume / (4 * M_PI * own::exp(3 * log_q));
  double seen = 0;
  for (int k = 0; k < harmonics_up_to(places.endo_degree); ++k) {
    if (!is_bulge(k)) continue;
    const int unknown = layout.terms[0][places.endo + k].front().unknown;
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(layout.unknowns, unknown);
    seen += own::pow(solution.unknowns[unknown], 2) + own::pow(factor.half_norm(unit), 2);
  }
  const double most = std::sqrt(seen / bulge_of_columns(places.endo_degree)) / log_q_by_share;
  return std::min(usual, most);
}

}  // namespace dynasurf::psf_fit
