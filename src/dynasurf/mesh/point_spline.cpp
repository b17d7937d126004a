#include "dynasurf/mesh/detail/point_spline.hpp"

#include <string>

#include "dynasurf/core/detail/mean_point.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf::mesh {
namespace {

void require_finite(std::span<const Vec3> points) {
  for (std::size_t n = 0; n < points.size(); ++n)
    if (!points[n].allFinite()) throw InputError("move_with_points: point " + std::to_string(n + 1) + " is not finite");
}

}  // namespace

PointSpline::PointSpline(std::span<const Vec3> rest, double smoothing) : rest_(rest.begin(), rest.end()) {
  if (rest.size() < 4)
    throw InputError("move_with_points: " + std::to_string(rest.size()) + " points; expected at least 4");
  require_finite(rest);
  const Eigen::Index n = rest.size();
  // Lengths near 1 keep the system well scaled.
  middle_ = mean_point(rest);
  size_ = 0;
  for (const Vec3& p : rest) size_ = std::max(size_, (p - middle_).norm());
  const auto scaled = [&](const Vec3& p) -> Vec3 { return (p - middle_) / size_; };
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + 4, n + 4);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) system(i, j) = (rest[i] - rest[j]).norm() / size_;
    system(i, i) -= smoothing / size_;  // |r| is conditionally negative
    system(i, n) = system(n, i) = 1;
    system.block<1, 3>(i, n + 1) = scaled(rest[i]).transpose();
    system.block<3, 1>(n + 1, i) = scaled(rest[i]);
  }
  constexpr double least_pivot = 1e-12;  // lengths are 1 or so
  if (size_ > 0) factor_.compute(system);
  if (!(size_ > 0) || !(factor_.matrixLU().diagonal().cwiseAbs().minCoeff() > least_pivot))
    throw InputError("move_with_points: the points lie in one plane or some are equal; expected points in space");
}

SplineMotion PointSpline::motion_to(std::span<const Vec3> now) const {
  if (rest_.size() != now.size())
    throw InputError("move_with_points: " + std::to_string(rest_.size()) + " points at rest and " +
                     std::to_string(now.size()) + " moved; expected as many");
  require_finite(now);
  const Eigen::Index n = rest_.size();
  Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(n + 4, 3);
  for (std::size_t i = 0; i < now.size(); ++i) moves.row(i) = (now[i] - rest_[i]).transpose();
  const Eigen::MatrixXd weights = factor_.solve(moves);
  SplineMotion motion;
  motion.rest_ = rest_;
  for (Eigen::Index i = 0; i < n; ++i) motion.weight_.emplace_back(weights.row(i).transpose() / size_);
  motion.linear_ = weights.bottomRows<3>().transpose() / size_;
  motion.shift_ = weights.row(n).transpose() - motion.linear_ * middle_;
  return motion;
}

Vec3 SplineMotion::at(const Vec3& p) const {
  Vec3 move = shift_ + linear_ * p;
  for (std::size_t i = 0; i < rest_.size(); ++i) move += (p - rest_[i]).norm() * weight_[i];
  return p + move;
}

Mat3 SplineMotion::gradient(const Vec3& p) const {
  Mat3 gradient = Mat3::Identity() + linear_;
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    const Vec3 from = p - rest_[i];
    const double distance = from.norm();
    if (distance > 1e-9) gradient += weight_[i] * from.transpose() / distance;
  }
  return gradient;
}

}  // namespace dynasurf::mesh
