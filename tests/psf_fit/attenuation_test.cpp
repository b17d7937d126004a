#include "dynasurf/psf_fit/detail/attenuation.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "round_heart.hpp"

namespace dynasurf::psf_fit {
namespace {

using test::dot;

constexpr int side = 32;
// Terms of one coefficient alone follow the usual one: plain left, back, head; cosine 1, left, ...; sine 1, ...
constexpr std::size_t plain_left = 1, cosine = 4, sine = 8;

Pixels all_pixels() {
  Pixels pixels;
  pixels.count = {side, side, side};
  pixels.spacing = Vec3::Constant(6);
  return pixels;
}

HeartFrame oblique_heart() {
  HeartFrame frame;
  frame.centre = Vec3::Constant(6 * (side - 1) / 2.0);
  frame.axes.col(2) = Vec3(-0.6, 0.6, 0.52915026221291817);
  frame.axes.col(0) = Vec3(1, 1, 0).normalized();
  frame.axes.col(1) = frame.axes.col(2).cross(frame.axes.col(0));
  return frame;
}

Study empty_study() {
  Study study;
  Grid grid;
  grid.dims = {side, side, side};
  grid.spacing = Vec3::Constant(6);
  study.gates.assign(2, Image(grid));
  return study;
}

/// A wave under a bell, along a direction.
std::vector<float> wave_along(const Vec3& direction) {
  const Pixels pixels = all_pixels();
  std::vector<float> values;
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const Vec3 p = Vec3(pixels.centre(0, i), pixels.centre(1, j), pixels.centre(2, k)) - oblique_heart().centre;
        values.push_back(static_cast<float>(std::cos(2 * M_PI * p.dot(direction) / 36) *
                                            std::exp(-p.squaredNorm() / (2 * 30 * 30))));
      }
  return values;
}

TEST(AttenuationImages, WeighTransverseFrequenciesByTheirDirection) {
  const std::vector<float> ones(all_pixels().size(), 1.0F);
  for (const double degrees : {0.0, 20.0, 45.0, 70.0, 90.0, 130.0}) {
    const double angle = degrees * M_PI / 180;
    const std::vector<float> wave = wave_along({std::cos(angle), std::sin(angle), 0});
    const std::vector<float> along = wave_along({0, 0, 1});
    const auto images = attenuation_images(empty_study(), all_pixels(), oblique_heart(), 1, {wave, along}, ones);
    ASSERT_EQ(images.size(), 12U);
    const double energy = dot(wave, wave);
    EXPECT_NEAR(dot(images[cosine][0], wave) / energy, std::cos(2 * angle), 0.1) << degrees;
    EXPECT_NEAR(dot(images[sine][0], wave) / energy, std::sin(2 * angle), 0.1) << degrees;
    EXPECT_NEAR(dot(images[cosine][1], along) / energy, 0, 0.1) << degrees;
  }
}

TEST(AttenuationImages, TheFirstIsTheUsualSumOfTheOthers) {
  const std::vector<float> ones(all_pixels().size(), 1.0F), wave = wave_along({0.6, 0.8, 0});
  const auto images = attenuation_images(empty_study(), all_pixels(), oblique_heart(), 1, {wave, wave}, ones);
  const double usual[] = {0.385, -0.256, 0.026, 0.156, -0.200, -0.332, -0.186, 0.201, 0.100, -0.465, -0.100};
  for (std::size_t n = 0; n < wave.size(); n += 97) {
    double sum = 0;
    for (std::size_t t = 0; t < 11; ++t) sum += usual[t] * static_cast<double>(images[1 + t][0][n]);
    EXPECT_NEAR(static_cast<double>(images[0][0][n]), sum, 1e-5);
  }
}

TEST(AttenuationImages, GrowWithThePlaceAndTakeTheStudyWhereNothingIsFitted) {
  Study study = empty_study();
  for (Image& gate : study.gates) std::fill(gate.values.begin(), gate.values.end(), 10.0F);
  const Pixels pixels = all_pixels();
  std::vector<float> weight(pixels.size(), 1.0F);
  const std::vector<float> model(pixels.size(), 3.0F);
  weight[5] = 0;
  const auto images = attenuation_images(study, pixels, oblique_heart(), 2, {model, model}, weight);
  const auto left = [&](int i) { return (pixels.centre(0, i) - oblique_heart().centre[0]) / 50; };
  EXPECT_NEAR(static_cast<double>(images[plain_left][0][7]), 3 * left(7), 1e-4);
  EXPECT_NEAR(static_cast<double>(images[plain_left][1][5]), 5 * left(5), 1e-4);
}

TEST(ToPatient, IsTheGridsOwnDirectionUnlessTheHeartLiesAlongTheBody) {
  Grid grid;
  EXPECT_EQ(to_patient(grid, oblique_heart()), grid.direction);
  HeartFrame untold;
  const Mat3 turn = to_patient(grid, untold);
  EXPECT_LT((turn * turn.transpose() - Mat3::Identity()).norm(), 1e-12);
  const Vec3 to_base = turn * untold.axes.col(2), lateral = turn * untold.axes.col(0);
  EXPECT_LT(to_base[0], -0.5) << "the apex lies to the left";
  EXPECT_GT(to_base[1], 0.5) << "and in front";
  EXPECT_NEAR(to_base[2], 0.5, 1e-12);
  EXPECT_GT(lateral[0], 0.7);
}

}  // namespace
}  // namespace dynasurf::psf_fit
