#include "dynasurf/psf_fit/detail/activity.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "psf_fit/round_heart.hpp"

namespace dynasurf::psf_fit {
namespace {

using test::dot;
using test::noise;
using test::round_heart;
using test::RoundHeart;

double cut_sphere(double radius, double height) {
  return M_PI * (2.0 / 3.0 * radius * radius * radius + radius * radius * height - height * height * height / 3);
}

TEST(Activity, HoldsTheVolumesOfItsWalls) {
  const RoundHeart heart = round_heart();
  const Activity activity = rasterise(heart.cells, heart.layout, heart.gate);
  // Smooth edges on cells of 2 mm: the sum is right to a few thousandths.
  EXPECT_NEAR(activity.cavity_mm3 / cut_sphere(20, 12), 1, 0.005);
  EXPECT_NEAR((activity.cavity_mm3 + activity.wall_mm3) / cut_sphere(30, 12), 1, 0.005);
}

TEST(Activity, GradientIsThatOfFiniteDifferences) {
  const RoundHeart heart = round_heart();
  const std::vector<float> by_cell = noise(heart.cells.lattice.size(), 4);
  const auto quantity = [&](const Eigen::VectorXd& gate) {
    const Activity a = rasterise(heart.cells, heart.layout, gate);
    return dot(a.cells, by_cell) + 2e-3 * a.cavity_mm3 - 1e-3 * a.wall_mm3;
  };
  const Activity activity = rasterise(heart.cells, heart.layout, heart.gate);
  const Eigen::VectorXd gradient = backpropagate(heart.cells, heart.layout, heart.gate, activity, by_cell, 2e-3, -1e-3);
  for (int n = 0; n < heart.layout.width; ++n) {
    const double step = n >= heart.layout.plane && n < heart.layout.cavity ? 2e-2 : 2e-3;
    Eigen::VectorXd more = heart.gate, less = heart.gate;
    more[n] += step, less[n] -= step;
    const double difference = (quantity(more) - quantity(less)) / (2 * step);
    EXPECT_NEAR(gradient[n], difference, 0.01 * std::abs(difference) + 0.3) << n;  // of sums of some 100
  }
}

}  // namespace
}  // namespace dynasurf::psf_fit
