#pragma once
#include <algorithm>
#include <vector>

#include <Eigen/Core>

#include "dynasurf/psf_fit/detail/activity.hpp"

namespace dynasurf::psf_fit {

/// What is believed of the wall's thickness in one gate: the mean of its log over directions below the base.
struct ThicknessPrior {
  Eigen::MatrixXd harmonics;  // one row per direction; none: nothing is believed
  Eigen::VectorXd mm_per_q;   // along each direction, across the wall
  std::vector<Vec3> directions;
  int gate = 0;
  double mean_mm = 10, log_sd = 0.2;
  bool is_given = false;  // by a person, of surfaces: `follow_slopes` is for it
};

/// A place on a wall that a person says: the wall's q along one direction in one gate.
struct PlacedPoint {
  Eigen::RowVectorXd harmonics;  // of the direction
  int gate = 0;
  bool is_outer = false;
  double log_q = 0, log_sd = 0;
};

/// Where the reported walls lie beside those that explain the image: `outwards` is added to the log of the inner wall's
/// q, the muscle per solid angle stays; then `papillary_share` and `edge_share` of the muscle along every ray count as
/// cavity, and the part `beyond` lies outside the outer wall.
struct ReportedWalls {
  std::vector<double> outwards;  // [gate]; none: nowhere
  double papillary_share = 0;
  std::vector<double> edge_share;  // [gate], of either sign (edge_volumes.hpp); none: 0
  double beyond = 0;               // of either sign

  /// Of the muscle, that counts as cavity.
  double cavity_share(std::size_t gate) const { return papillary_share + (edge_share.empty() ? 0 : edge_share[gate]); }
};

/// Cube of the reported inner wall's q, from those of the cavity and of the muscle. However much is taken from a
/// cavity, some of it stays.
inline double reported_cavity(double cavity, double muscle, double share) {
  constexpr double least = 0.2;
  return std::max(cavity + share * muscle, least * cavity);
}

/// A beat to be explained: pixels of all gates, and the model that explains them.
struct BeatProblem {
  Pixels pixels;
  std::vector<std::vector<float>> values;  // [gate][pixel], healthy muscle near 1
  std::vector<float> weight;               // [pixel] relative precision, 0: not looked at
  double noise = 1;                        // variance of a pixel of weight 1, times the pixels that share their noise
  std::vector<std::vector<float>> blobs;   // [blob][pixel] neighbours of amplitude 1, as the camera sees them
  // [term][gate][pixel] what attenuation of amplitude 1 adds (attenuation.hpp); none: it is not looked for
  std::vector<std::vector<std::vector<float>>> attenuation;
  HeartCells cells;
  BeatLayout layout;
  double sigma_mm = 0;  // of the point spread when its unknown is 0
  double filtered = 0;  // share of its variance that comes from a filter on the voxels
  ThicknessPrior thickness;
  std::vector<PlacedPoint> points;  // on the reported walls
  ReportedWalls reported;
  double wall_relative_sd = 0.01;  // relative, by which the muscle's volume may vary over the beat
};

/// Standard deviations of the point spread along the grid's axes, mm.
Vec3 point_spread(const BeatProblem& problem, const Eigen::VectorXd& gate);

}  // namespace dynasurf::psf_fit
