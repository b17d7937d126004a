#include "dynasurf/ventricle/detail/quality_metrics.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/synthetic/detail/noise.hpp"

namespace dynasurf::ventricle {
namespace {

const heart::LvShell cup{{60, 60, 60}, {0, 0, 1}, 28, 45, 24};

Grid roomy_grid() {
  Grid grid;
  grid.dims = {61, 61, 61};
  grid.spacing = {2, 2, 2};
  return grid;
}

/// A blurred wall of brightness 1 on the cup, and beside it a blurred ball.
Image wall_and_ball(double ball, const Vec3& at) {
  Image image(roomy_grid());
  for (int k = 0; k < 61; ++k)
    for (int j = 0; j < 61; ++j)
      for (int i = 0; i < 61; ++i) {
        const Vec3 p = centre_of(image.grid, {i, j, k});
        const double from_wall = signed_distance(cup, p), from_ball = (p - at).norm() / 18;
        image(i, j, k) =
            static_cast<float>(std::exp(-from_wall * from_wall / 72) + ball * std::exp(-std::pow(from_ball, 4)));
      }
  return image;
}

TEST(HotNeighbour, IsSeenWhereItTouchesTheWall) {
  EXPECT_EQ(hot_neighbour_share(wall_and_ball(0, Vec3::Zero()), cup), 0);
  const double touching = hot_neighbour_share(wall_and_ball(2, {109, 60, 60}), cup);
  EXPECT_GT(touching, 0.02);
  EXPECT_LT(touching, 0.3) << "on one side only";
}

TEST(HotNeighbour, DoesNotCountWhatIsDimOrApart) {
  EXPECT_EQ(hot_neighbour_share(wall_and_ball(0.4, {109, 60, 60}), cup), 0) << "a right ventricle";
  EXPECT_EQ(hot_neighbour_share(wall_and_ball(1, {128, 60, 60}), cup), 0) << "a dark gap lies between";
}

TEST(NoiseOfWall, IsTheSpreadFromGateToGate) {
  const Image wall = wall_and_ball(0, Vec3::Zero());
  std::vector<Image> gates;
  for (std::uint64_t g = 0; g < 16; ++g) gates.push_back(synthetic::add_gaussian_noise(wall, 0.1, 3, g));
  // Linear interpolation between voxels averages the noise of 8 of them: 0.3 to 1 of it is left.
  EXPECT_GT(noise_of_wall(gates, cup), 0.03);
  EXPECT_LT(noise_of_wall(gates, cup), 0.1);
  EXPECT_NEAR(noise_of_wall(std::vector<Image>(16, wall), cup), 0, 1e-4);
  EXPECT_EQ(noise_of_wall(std::vector<Image>(2, wall), cup), 0) << "too few gates to tell";
}

}  // namespace
}  // namespace dynasurf::ventricle
