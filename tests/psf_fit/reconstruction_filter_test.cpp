#include "dynasurf/psf_fit/detail/reconstruction_filter.hpp"

#include <array>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "dynasurf/core/detail/fourier.hpp"
#include "dynasurf/synthetic/detail/random.hpp"

namespace dynasurf::psf_fit {
namespace {

constexpr Index3 dims{64, 64, 32};
constexpr double spacing_mm = 6.4;

Grid test_grid() {
  Grid grid;
  grid.dims = dims;
  grid.spacing = Vec3::Constant(spacing_mm);
  return grid;
}

double butterworth(double f, double cutoff, double order) { return 1 / std::sqrt(1 + std::pow(f / cutoff, 2 * order)); }
double gaussian(double f, double sigma_mm) { return std::exp(-2 * M_PI * M_PI * sigma_mm * sigma_mm * f * f); }

/// Gates of white noise behind a ramp across the patient and a filter, as a reconstruction leaves it.
Study reconstructed_noise(const std::function<double(double)>& filter, std::uint64_t seed) {
  const std::array<FourierTable, 3> tables{make_fourier_table(dims[0]), make_fourier_table(dims[1]),
                                           make_fourier_table(dims[2])};
  Study study;
  synthetic::Random random(seed);
  for (int gate = 0; gate < 8; ++gate) {
    std::vector<Complex> values(static_cast<std::size_t>(dims[0] * dims[1] * dims[2]));
    for (Complex& v : values) v = {random.normal(), 0};
    transform_box(tables, values, -1);
    const auto frequency = [](int k, int n) { return (k < n / 2 ? k : k - n) / (n * spacing_mm); };
    std::size_t at = 0;
    for (int k = 0; k < dims[2]; ++k)
      for (int j = 0; j < dims[1]; ++j)
        for (int i = 0; i < dims[0]; ++i, ++at) {
          const double x = frequency(i, dims[0]), y = frequency(j, dims[1]), z = frequency(k, dims[2]);
          const double factor = std::sqrt(std::hypot(x, y)) * filter(std::hypot(x, y, z));
          values[at] = {factor * values[at].re, factor * values[at].im};
        }
    transform_box(tables, values, 1);
    Image image(test_grid());
    for (std::size_t n = 0; n < values.size(); ++n) image.values[n] = static_cast<float>(values[n].re);
    study.gates.push_back(std::move(image));
  }
  return study;
}

/// A Gaussian ball of activity seen through a filter: its radial Fourier integral.
Study ball_through(const std::function<double(double)>& filter) {
  constexpr double own_sigma_mm = 9, step = 1e-4;
  const auto value = [&](double r) {
    double sum = 0;
    for (double f = step / 2; f < 0.078; f += step) {
      const double angle = 2 * M_PI * f * r;
      sum += 4 * M_PI * f * f * filter(f) * gaussian(f, own_sigma_mm) * (angle < 1e-9 ? 1 : std::sin(angle) / angle) *
             step;
    }
    return 1e5 * sum;
  };
  Study study;
  Image image(test_grid());
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i) {
        const double r = spacing_mm * std::hypot(i - 31.3, j - 33.1, k - 15.6);
        image(i, j, k) = r < 90 ? static_cast<float>(value(r)) : 0.0F;
      }
  study.gates.assign(3, image);
  return study;
}

TEST(ReconstructionFilter, TheNoiseShowsItsCutoffAndOrder) {
  for (const double cutoff : {0.032, 0.045}) {
    const auto filter = filter_in_noise(reconstructed_noise([&](double f) { return butterworth(f, cutoff, 5); }, 3));
    ASSERT_TRUE(filter) << cutoff;
    EXPECT_NEAR(filter->cutoff_per_mm, cutoff, 0.002);
    EXPECT_NEAR(filter->order, 5, 1);
  }
}

TEST(ReconstructionFilter, GaussianNoiseShowsNone) {
  EXPECT_FALSE(filter_in_noise(reconstructed_noise([](double f) { return gaussian(f, 4.2); }, 4)));
  EXPECT_FALSE(filter_in_noise(reconstructed_noise([](double) { return 1.0; }, 5)));
}

TEST(ReconstructionFilter, NoGatesNoFilter) {
  Study study = reconstructed_noise([](double f) { return butterworth(f, 0.035, 5); }, 6);
  study.gates.resize(5);
  EXPECT_FALSE(filter_in_noise(study));
}

TEST(ReconstructionFilter, AGaussianTakesItsPlaceExactly) {
  const ReconstructionFilter filter{0.035, 5};
  const double sigma_mm = gaussian_in_place_of(filter);
  EXPECT_GT(sigma_mm, 3);
  EXPECT_LT(sigma_mm, 8);
  const Study study = ball_through([&](double f) { return butterworth(f, filter.cutoff_per_mm, filter.order); });
  const Study expected = ball_through([&](double f) { return gaussian(f, sigma_mm); });
  const VoxelBox box{{16, 16, 2}, {32, 32, 28}};
  const Study got = with_gaussian_filter(study, filter, sigma_mm, box);
  const float peak = expected.gates[0](31, 33, 16);
  for (std::size_t g = 0; g < 3; ++g)
    for (int k = 6; k < 26; ++k)
      for (int j = 20; j < 44; ++j)
        for (int i = 20; i < 44; ++i)
          ASSERT_NEAR(got.gates[g](i, j, k), expected.gates[g](i, j, k), 0.01F * peak) << i << ' ' << j << ' ' << k;
  EXPECT_EQ(got.gates[0](3, 3, 3), study.gates[0](3, 3, 3));
}

}  // namespace
}  // namespace dynasurf::psf_fit
