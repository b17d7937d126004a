#include "dynasurf/synthetic/detail/noise.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/synthetic/detail/render.hpp"

namespace dynasurf::synthetic {
namespace {

Image even_image(float value) {
  Grid grid;
  grid.dims = {64, 64, 48};
  return Image(grid, value);
}

struct Statistics {
  double mean = 0, variance = 0, neighbours = 0;  // the last: correlation of neighbours along i
};

/// Over the inside of the image, where the filter has not met the border.
Statistics statistics_of(const Image& image) {
  const Index3 dims = image.grid.dims;
  Statistics s;
  double n = 0, shared = 0;
  const auto each = [&](const auto& visit) {
    for (int k = 8; k < dims[2] - 8; ++k)
      for (int j = 8; j < dims[1] - 8; ++j)
        for (int i = 8; i < dims[0] - 8; ++i)
          visit(static_cast<double>(image(i, j, k)), static_cast<double>(image(i + 1, j, k)));
  };
  each([&](double a, double) { s.mean += a, ++n; });
  s.mean /= n;
  each([&](double a, double b) { s.variance += (a - s.mean) * (a - s.mean), shared += (a - s.mean) * (b - s.mean); });
  s.neighbours = shared / s.variance;
  s.variance /= n;
  return s;
}

// 73,728 voxels: a mean is known to sd / 271, a variance to 0.52 %, a correlation to 0.0037. Bounds are four to five
// times that.

TEST(DrawCounts, GivesVarianceEqualToTheMeanAndIndependentNeighbours) {
  for (double mean : {3.0, 60.0, 400.0}) {
    const Statistics s = statistics_of(draw_counts(even_image(static_cast<float>(mean)), 9, 0));
    EXPECT_NEAR(s.mean, mean, 5 * std::sqrt(mean) / 271);
    EXPECT_NEAR(s.variance / mean, 1, 0.026 + 0.01 / mean);
    EXPECT_NEAR(s.neighbours, 0, 0.017);
  }
}

TEST(DrawCounts, FilteredKeepsTheMeanAndSharesNoiseBetweenNeighbours) {
  // Autocorrelation of the discrete Gaussian: exp(-2t) I_n(2t) at distance n.
  const double fwhm = 3, t = sigma_of_fwhm(fwhm) * sigma_of_fwhm(fwhm);
  const double at_0 = std::exp(-2 * t) * std::cyl_bessel_i(0, 2 * t),
               at_1 = std::exp(-2 * t) * std::cyl_bessel_i(1, 2 * t);
  const Statistics s = statistics_of(blur(draw_counts(even_image(100), 9, 0), fwhm));
  EXPECT_NEAR(s.mean, 100, 0.2);
  // About 33 neighbours go together, which leaves a variance known to 3 %.
  EXPECT_NEAR(s.variance / (100 * at_0 * at_0 * at_0), 1, 0.1);
  EXPECT_NEAR(s.neighbours, at_1 / at_0, 0.02);
}

TEST(DrawCounts, GivesOtherCountsToOtherGates) {
  const Image mean = even_image(50);
  const Image a = draw_counts(mean, 1, 0), b = draw_counts(mean, 1, 1);
  Image difference = a;
  for (std::size_t v = 0; v < a.values.size(); ++v) difference.values[v] -= b.values[v];
  EXPECT_NEAR(statistics_of(difference).variance, 100, 3) << "independent gates add their variances";
}

TEST(DrawCounts, TakesNegativeMeansAsNothing) {
  for (float v : draw_counts(even_image(-4), 1, 0).values) ASSERT_EQ(v, 0.0f);
}

TEST(AddGaussianNoise, HasTheStandardDeviationAskedForAndIndependentNeighbours) {
  const Statistics s = statistics_of(add_gaussian_noise(even_image(20), 3, 5, 0));
  EXPECT_NEAR(s.mean, 20, 5 * 3.0 / 271);
  EXPECT_NEAR(s.variance / 9, 1, 0.026);
  EXPECT_NEAR(s.neighbours, 0, 0.017);
}

TEST(AddGaussianNoise, IsTheSameForAnyThreadCount) {
  const ThreadLimit one(1);
  const Image a = add_gaussian_noise(even_image(20), 3, 5, 0);
  const ThreadLimit four(4);
  EXPECT_EQ(add_gaussian_noise(even_image(20), 3, 5, 0).values, a.values);
  EXPECT_NE(add_gaussian_noise(even_image(20), 3, 6, 0).values, a.values);
}

}  // namespace
}  // namespace dynasurf::synthetic
