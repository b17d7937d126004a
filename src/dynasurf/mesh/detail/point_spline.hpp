#pragma once
#include <span>
#include <vector>

#include <Eigen/LU>

#include "dynasurf/core/grid.hpp"

namespace dynasurf::mesh {

/// A motion of all of space: a linear map and radial functions |r| around points.
class SplineMotion {
 public:
  /// Where the material at `p` goes.
  Vec3 at(const Vec3& p) const;
  /// The deformation gradient there: how small pieces of material are turned and stretched. At a point of the spline
  /// itself, where |r| has a tip, that of its surroundings.
  Mat3 gradient(const Vec3& p) const;

 private:
  friend class PointSpline;
  SplineMotion() = default;
  std::vector<Vec3> rest_, weight_;
  Vec3 shift_{0, 0, 0};
  Mat3 linear_ = Mat3::Zero();
};

/// The motions that take points to given places and bend as little as that allows between them (the biharmonic spline
/// in space, Duchon 1977). The points at rest are solved for once, so many motions cost little.
class PointSpline {
 public:
  /// With a `smoothing` of 0 mm every point is met, with more noisy ones may be missed. Throws InputError for fewer
  /// than 4 points, points in one plane, equal points, or numbers that are not finite.
  explicit PointSpline(std::span<const Vec3> rest, double smoothing = 0);
  /// Throws InputError for another number of points, or numbers that are not finite.
  SplineMotion motion_to(std::span<const Vec3> now) const;

 private:
  std::vector<Vec3> rest_;
  Vec3 middle_{0, 0, 0};
  double size_ = 1;
  Eigen::PartialPivLU<Eigen::MatrixXd> factor_;
};

}  // namespace dynasurf::mesh
