#include "dynasurf/psf_fit/detail/pixel_noise.hpp"

#include <gtest/gtest.h>

#include "psf_fit/round_heart.hpp"

namespace dynasurf::psf_fit {
namespace {

using test::noise;

constexpr int gates = 8, side = 14;
constexpr double noise_variance = 0.06 * 0.06 / 12;

/// Pixels of weight 1, and residuals of noise that differs from gate to gate.
BeatProblem even_pixels() {
  BeatProblem problem;
  problem.pixels.count = {side, side, side};
  problem.pixels.spacing = {5, 5, 5};
  problem.sigma_mm = 6;
  problem.weight.assign(side * side * side, 1.0F);
  return problem;
}
Objective noisy(double standing) {
  Objective objective;
  const std::vector<float> still = noise(side * side * side, 100);
  for (int g = 0; g < gates; ++g) {
    objective.residual.push_back(noise(still.size(), static_cast<std::uint64_t>(g + 1)));
    for (std::size_t n = 0; n < still.size(); ++n)
      objective.residual.back()[n] = 0.06F * objective.residual.back()[n] + static_cast<float>(standing) * still[n];
  }
  return objective;
}

TEST(PixelNoise, SeesNoMisfitInNoise) {
  const PixelNoise seen = noise_of(even_pixels(), noisy(0));
  EXPECT_LT(seen.misfit_seen, 0.1 * noise_variance / gates);
  EXPECT_NEAR(seen.of_errors, noise_variance + gates * usual_misfit, 0.05 * noise_variance);
  EXPECT_NEAR(seen.of_steps, seen.of_errors, 0.1 * noise_variance);
}

TEST(PixelNoise, CountsWhatStandsStillInTheStepsAlone) {
  const double standing_variance = 0.08 * 0.08 / 12;
  const PixelNoise seen = noise_of(even_pixels(), noisy(0.08));
  EXPECT_NEAR(seen.misfit_seen, standing_variance, 0.1 * standing_variance);
  EXPECT_NEAR(seen.of_errors, noise_of(even_pixels(), noisy(0)).of_errors, 1e-6);
  EXPECT_NEAR(seen.of_steps - seen.of_errors, gates * 1.5 * seen.misfit_seen, 1e-9);
}

TEST(PixelNoise, TakesTheTextureOfSharpImagesForNoMisfit) {
  BeatProblem sharp = even_pixels();
  sharp.sigma_mm = 0;
  EXPECT_EQ(noise_of(sharp, noisy(0.08)).misfit_seen, 0);
}

}  // namespace
}  // namespace dynasurf::psf_fit
