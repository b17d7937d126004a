#pragma once
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "dynasurf/psf_fit/detail/cholesky.hpp"
#include "dynasurf/psf_fit/detail/fitted_beat.hpp"
#include "dynasurf/psf_fit/detail/least_squares.hpp"

namespace dynasurf::psf_fit {

/// Places on the two walls of one gate, world frame; absent ones take no part.
struct WallPoints {
  std::vector<std::optional<Vec3>> endo, epi;
};

/// How numbers depend on the walls of one gate at some points: a row per point, a column per number. A wall moves along
/// the ray from the heart's centre through the point, in mm; the uptake is that at the inner point.
struct WallDependence {
  Eigen::MatrixXd by_endo, by_epi, by_log_uptake;  // no columns: not at all
};

/// What the data leave open of a fitted beat: how sure any number is that depends smoothly on the walls. World frame.
class WallPosterior {
 public:
  /// `factor`: of the normal matrix at `unknowns`.
  WallPosterior(const BeatProblem& problem, const Eigen::VectorXd& unknowns, const Grid& grid, const Cholesky& factor);

  /// Derivatives of no numbers yet: a column each.
  Eigen::MatrixXd no_gradient(Eigen::Index numbers) const;
  /// Adds the derivatives by the fit's unknowns of what depends on the walls of `gate`.
  void add(int gate, const WallPoints& points, const WallDependence& dependence, Eigen::MatrixXd& gradient) const;
  /// Standard deviation of each number.
  Eigen::VectorXd sd(const Eigen::MatrixXd& gradient) const;

 private:
  BeatLayout layout_;
  HeartFrame frame_;
  Grid grid_;
  std::vector<Eigen::VectorXd> gates_;  // numbers of each
  Cholesky factor_;
};

/// How much of what is said of the wall's mean thickness and of the point spread's width comes from the data: 1 less
/// the variance that is left over the variance that was believed before. 0: nothing; 1: all. Says so in the beat's
/// notes where less than half does, and where the wall is thinner than 0.65 of the point spread's width.
void tell_belief_from_data(const BeatProblem& problem, const Solution& solution, const Cholesky& factor,
                           FittedBeat& beat);

}  // namespace dynasurf::psf_fit
