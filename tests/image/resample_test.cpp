#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "dynasurf/image/detail/linear_sampler.hpp"
#include "dynasurf/image/intensity.hpp"

namespace dynasurf::image {
namespace {

Grid small_grid() {
  Grid grid;
  grid.dims = {9, 8, 7};
  grid.spacing = {2, 3, 4};
  return grid;
}

template <class F>
Image filled(const Grid& grid, F value) {
  Image image(grid);
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) image(i, j, k) = static_cast<float>(value(centre_of(grid, {i, j, k})));
  return image;
}

TEST(SampleLinear, IsExactForLinearImagesAndConstantOutside) {
  const auto value = [](const Vec3& p) { return 3 + p[0] - 2 * p[1] + 0.5 * p[2]; };
  const Image image = filled(small_grid(), value);
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(3.7, 8.2, 11.1), Vec3(16, 21, 24)})
    EXPECT_NEAR(sample_linear(image, p), value(p), 1e-5);
  EXPECT_NEAR(sample_linear(image, {-5, 0, 0}), value({0, 0, 0}), 1e-5);
  EXPECT_NEAR(sample_linear(image, {99, 99, 99}), value({16, 21, 24}), 1e-5);
}

TEST(SampleLinear, GivesManyPointsTheValuesOfEach) {
  const Image image = filled(small_grid(), [](const Vec3& p) { return std::sin(p[0]) + std::cos(3 * p[1] * p[2]); });
  SampledPoints<37> points;
  std::vector<Vec3> each;
  for (int n = 0; n < 37; ++n) {
    each.emplace_back(0.7 * n - 4, 29 - 0.9 * n, 0.6 * n);  // some beside the image
    points.add(each.back());
  }
  const LinearSampler sample(image);
  std::array<double, 37> values{};
  sample(points, values.data());
  for (std::size_t n = 0; n < values.size(); ++n) EXPECT_EQ(values[n], sample_linear(image, each[n])) << n;
}

TEST(SampleCubic, RepeatsTheOutermostVoxels) {
  Grid grid;
  grid.dims = {5, 6, 7};
  const Image image = filled(grid, [](const Vec3& p) { return std::sin(p[0]) + std::cos(3 * p[1] * p[2]); });
  Grid wider;
  wider.dims = {11, 12, 13};
  const Image padded = filled(wider, [&](const Vec3& p) {
    return image.clamped(static_cast<int>(p[0]) - 3, static_cast<int>(p[1]) - 3, static_cast<int>(p[2]) - 3);
  });
  for (double z = 0; z <= 6; z += 0.75)
    for (double y = 0; y <= 5; y += 0.625)
      for (double x = 0; x <= 4; x += 0.5)
        ASSERT_EQ(sample_cubic(image, {x, y, z}), sample_cubic(padded, {x + 3, y + 3, z + 3}))
            << x << ' ' << y << ' ' << z;
}

TEST(SampleCubic, IsExactForParabolas) {
  const auto value = [](const Vec3& p) { return 100 + p[0] * p[0] - p[1] * p[2] + 0.25 * p[2] * p[2]; };
  const Image image = filled(small_grid(), value);
  for (const Vec3& p : {Vec3(4, 9, 8), Vec3(5.3, 10.1, 13.7), Vec3(11.9, 4.4, 6.5)})  // a voxel away from the sides
    EXPECT_NEAR(sample_cubic(image, p), value(p), 1e-3);
}

TEST(Resample, ToTheSameGridChangesNothing) {
  const Image image = filled(small_grid(), [](const Vec3& p) { return std::sin(p[0]) + std::cos(p[1] * p[2]) + 2; });
  EXPECT_EQ(resample(image, image.grid).values, image.values);
}

TEST(Resample, IsEmptyOutsideAndNeverBelowZero) {
  const Image image = filled(small_grid(), [](const Vec3& p) { return p[0] == 8 ? 10.0 : 0.0; });
  Grid finer = small_grid();
  finer.spacing = {0.7, 3, 4};
  finer.dims[0] = 60;
  const Image result = resample(image, finer);
  for (float v : result.values) EXPECT_GE(v, 0);
  EXPECT_EQ(result(59, 2, 2), 0) << "beyond the side";
}

TEST(SmoothGaussian, HasTheVarianceAskedForAndKeepsTheSum) {
  Grid grid;
  grid.dims = {41, 41, 41};
  grid.spacing = {2, 2, 2};
  Image point(grid);
  point(20, 20, 20) = 1000;
  const Image smooth = smooth_gaussian(point, 5);
  double sum = 0, second = 0;
  for (int k = 0; k < 41; ++k)
    for (int j = 0; j < 41; ++j)
      for (int i = 0; i < 41; ++i) sum += smooth(i, j, k), second += smooth(i, j, k) * 4.0 * (i - 20) * (i - 20);
  EXPECT_NEAR(sum, 1000, 0.1);
  EXPECT_NEAR(std::sqrt(second / sum), 5, 0.1) << "the kernel ends at three standard deviations";
  EXPECT_EQ(smooth_gaussian(point, 0).values, point.values);
}

}  // namespace
}  // namespace dynasurf::image
