#include "dynasurf/core/detail/symmetric_axes.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dynasurf {
namespace {

Mat3 matrix_of(const Vec3& values, const Mat3& directions) {
  return directions * values.asDiagonal() * directions.transpose();
}

Mat3 some_rotation(double n) {
  const Vec3 x = Vec3(std::sin(n), std::cos(3 * n), std::sin(7 * n + 1)).normalized();
  const Vec3 y = x.cross(Vec3(std::cos(n), 1, std::sin(5 * n))).normalized();
  Mat3 m;
  m << x, y, x.cross(y);
  return m;
}

TEST(SymmetricAxes, AreThoseThatAMatrixWasMadeOf) {
  for (int n = 0; n < 500; ++n)
    for (const Vec3& values : {Vec3(-2, 1, 5), Vec3(0, 1, 1), Vec3(1e-9, 1, 1e3), Vec3(-1, -1, 2), Vec3(3, 3, 3)}) {
      const Mat3 m = matrix_of(values, some_rotation(n));
      const SymmetricAxes axes = symmetric_axes(m);
      const double size = values.cwiseAbs().maxCoeff();
      EXPECT_LT((axes.values - values).norm(), 1e-14 * size) << n;
      EXPECT_LT((matrix_of(axes.values, axes.directions) - m).norm(), 4e-15 * size) << n;
      EXPECT_LT((axes.directions.transpose() * axes.directions - Mat3::Identity()).norm(), 4e-15) << n;
      EXPECT_GT(axes.directions.determinant(), 0.99) << n;
    }
}

TEST(SymmetricAxes, HoldForTinyAndHugeMatrices) {
  for (const double size : {1e-300, 1e-150, 1e150, 1e300}) {
    const Vec3 values = size * Vec3(1, 2, 3);
    EXPECT_LT(((symmetric_axes(matrix_of(values, some_rotation(1))).values - values) / size).norm(), 1e-14);
  }
  EXPECT_EQ(symmetric_axes(Mat3::Zero()).values, Vec3(0, 0, 0));
}

TEST(SymmetricAxes, AreNotANumberForWhatIsNone) {
  Mat3 m = Mat3::Identity();
  m(0, 2) = m(2, 0) = NAN;
  EXPECT_TRUE(std::isnan(symmetric_axes(m).values[0]));
}

TEST(SymmetricAxes, OfADiagonalMatrixAreSortedAndKeepTheirBytes) {
  const SymmetricAxes axes = symmetric_axes(Vec3(3, 1, 2).asDiagonal());
  EXPECT_EQ(axes.values, Vec3(1, 2, 3));
  EXPECT_EQ(std::abs(axes.directions(1, 0)), 1);
}

}  // namespace
}  // namespace dynasurf
