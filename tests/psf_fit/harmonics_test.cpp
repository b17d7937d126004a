#include "dynasurf/psf_fit/detail/harmonics.hpp"

#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

namespace dynasurf::psf_fit {
namespace {

TEST(Harmonics, AreOrthonormalOverTheSphere) {
  constexpr int degree = 6, count = harmonics_up_to(degree), directions = 20000;
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(count, count);
  std::vector<double> values(count);
  for (int n = 0; n < directions; ++n) {
    real_spherical_harmonics(fibonacci_direction(n, directions), degree, values);
    const Eigen::Map<Eigen::VectorXd> v(values.data(), count);
    products += v * v.transpose() / directions;
  }
  // The lattice integrates harmonics of degree 12 to about one part in its number of points.
  EXPECT_LT((products - Eigen::MatrixXd::Identity(count, count)).cwiseAbs().maxCoeff(), 1e-3);
}

}  // namespace
}  // namespace dynasurf::psf_fit
