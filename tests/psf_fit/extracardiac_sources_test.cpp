#include "dynasurf/psf_fit/detail/extracardiac_sources.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace dynasurf::psf_fit {
namespace {

BeatProblem wide_problem() {
  BeatProblem problem;
  problem.pixels.count = {40, 30, 20};
  problem.pixels.spacing = {6, 6, 6};
  problem.sigma_mm = 5;
  problem.weight.assign(problem.pixels.size(), 1.0F);
  return problem;
}

TEST(ExtracardiacSources, AreSpotsThatFadeToNothing) {
  const BeatProblem problem = wide_problem();
  const std::vector<float> image = blob_image(problem, {{0, 0, 0}});
  ASSERT_EQ(image.size(), problem.pixels.size());
  EXPECT_EQ(image.front(), 1);
  EXPECT_EQ(image.back(), 0);
  // Neither a value nor the product of two is subnormal: such numbers take a hundred times as long.
  for (const float v : image) ASSERT_TRUE(v == 0 || std::isnormal(v * v)) << v;
  const auto seen = std::count_if(image.begin(), image.end(), [](float v) { return v > 0; });
  EXPECT_LT(seen, std::ssize(image) / 4);
}

TEST(ExtracardiacSources, AreFoundWhereTheDataAreBrighter) {
  const BeatProblem problem = wide_problem();
  const Index3 at{25, 12, 8};
  const Vec3 centre(problem.pixels.centre(0, at[0]), problem.pixels.centre(1, at[1]), problem.pixels.centre(2, at[2]));
  Objective objective;
  objective.residual.push_back(blob_image(problem, {centre}));
  for (float& v : objective.residual.front()) v *= -0.5F;
  std::vector<bool> allowed(problem.pixels.size(), true);
  const std::vector<ExtracardiacSource> found = find_extracardiac_sources(problem, objective, allowed, 0.1, 5);
  ASSERT_FALSE(found.empty());
  EXPECT_LT((found.front().centre - centre).norm(), 1e-9);
  allowed.assign(allowed.size(), false);
  EXPECT_TRUE(find_extracardiac_sources(problem, objective, allowed, 0.1, 5).empty());
}

}  // namespace
}  // namespace dynasurf::psf_fit
