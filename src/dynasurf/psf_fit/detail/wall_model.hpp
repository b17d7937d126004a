#pragma once
#include <vector>

#include <Eigen/Core>

#include "dynasurf/core/grid.hpp"

namespace dynasurf::psf_fit {

/// Where the model of a ventricle lies: mm of the grid frame of the fitted study.
///
/// A point of the heart's frame (mm, z from apex to base) divided by `scale` has a distance q from the centre and a
/// direction; both walls are given as q of the direction, so that a heart is nearly a unit sphere.
struct HeartFrame {
  Vec3 centre{0, 0, 0};
  Mat3 axes = Mat3::Identity();  // columns: the heart's x, y, z
  Vec3 scale{1, 1, 1};

  Vec3 to_heart(const Vec3& p) const { return axes.transpose() * (p - centre); }
  Vec3 from_heart(const Vec3& p) const { return centre + axes * p; }
};

/// Places of the numbers that describe one gate.
struct GateLayout {
  int endo_degree = 0, wall_degree = 0, uptake_degree = 0;
  int endo = 0;         // harmonics of log q of the inner wall
  int wall = 0;         // harmonics of log(q_epi^3 - q_endo^3): muscle per solid angle
  int uptake = 0;       // harmonics of the log of the wall's activity, the same in all gates
  int plane = 0;        // height of the base plane (mm over the centre), and its slopes along x and y
  int cavity = 0;       // activity of the blood
  int background = 0;   // activity around the heart
  int width = 0;        // log of the point spread's standard deviation over its start, the geometric mean of its axes
  int stretch = 0;      // log of its deviation along the slices' normal over that in the slices; along x over along y
  int attenuation = 0;  // amplitudes of what uncorrected attenuation adds
  int attenuation_count = 0;
  int blobs = 0;  // amplitudes of neighbours
  int blob_count = 0;
  int count() const { return blobs + blob_count; }
};
/// Lays the numbers of a gate one after the other.
GateLayout make_gate_layout(int endo_degree, int wall_degree, int uptake_degree, int blob_count,
                            int attenuation_count = 0);

/// Logs of the point spread's deviations along the grid's axes over their start: a row per axis, a column each for
/// `width` and the two of `stretch`.
inline const Mat3 log_widths{{1, -1.0 / 3, 0.5}, {1, -1.0 / 3, -0.5}, {1, 2.0 / 3, 0}};

/// The numbers of all gates as a linear function of the unknowns of the whole beat: shapes and motion are a few waves
/// in time, activities and slopes are common to all gates.
struct BeatLayout {
  struct Term {
    int unknown;
    double factor;
  };
  GateLayout gate;
  int gates = 0, unknowns = 0;
  std::vector<std::vector<std::vector<Term>>> terms;  // [gate][number of the gate]
  Eigen::VectorXd expected, spread;                   // prior of each unknown: mean and standard deviation

  Eigen::VectorXd at_gate(int g, const Eigen::VectorXd& unknowns_of_beat) const;
  std::vector<Eigen::VectorXd> at_gates(const Eigen::VectorXd& unknowns_of_beat) const;
  void add_gradient(int g, const Eigen::VectorXd& of_gate, Eigen::VectorXd& of_beat) const;
  /// The lower triangle of all gates' Hessians together; the upper one is not set.
  Eigen::MatrixXd hessian(const std::vector<Eigen::MatrixXd>& of_gates) const;
};

/// What is believed before the data are seen: standard deviations of the model's numbers.
struct Priors {
  double size = 0.3;           // of a wall's harmonic of degree 0, log q
  double shape = 0.12;         // of those of degree 1 and 2: this divided by l
  double fine_shape = 0.15;    // of harmonics of degree l >= 3: this times (2 / l)^2.5
  double beating = 0.30;       // of the motion of degree 0, first wave
  double motion = 0.04;        // of that of degree 1 and 2: where a wall cannot be seen it moves with the others
  double fine_motion = 0.02;   // of that of degree l >= 3, times (2 / l)^2
  double wall_shape = 0.15;    // of log muscle per solid angle, degree l: this divided by l
  double wall_motion = 0.12;   // the same over the beat
  double uptake = 0.35;        // of log uptake around what the rays show, degree l: this divided by l
  double plane_mm = 2.5;       // of the base plane's height around its start
  double plane_slope = 0.06;   // of its slopes
  double cavity = 0.05;        // of the blood's activity around its expectation
  double cavity_level = 0.08;  // its expectation, healthy muscle is 1
  double width = 0;            // relative, of the point spread; 0: known
  double attenuation = 0.5;    // its amplitude, 1 in a chest that is not corrected: mean and standard deviation
  double coefficient = 0.05;   // of its coefficients around the usual ones
  double stretch = 0;          // of the logs of ratios of its widths; 0: the same along all axes
};

/// `start`: the numbers of each gate to begin with. Low harmonics are believed around them, fine ones around 0.
BeatLayout make_beat_layout(const GateLayout& gate, const std::vector<Eigen::VectorXd>& start, const Priors& beliefs,
                            Eigen::VectorXd& unknowns);

}  // namespace dynasurf::psf_fit
