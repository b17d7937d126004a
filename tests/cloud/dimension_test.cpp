#include "dynasurf/cloud/detail/dimension.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"
#include "dynasurf/synthetic/detail/random.hpp"

namespace dynasurf::cloud {
namespace {

PointCloud fog(int count, bool is_round) {
  PointCloud cloud;
  for (int n = 0; n < count; ++n) {
    synthetic::Random random(1, 0, static_cast<std::uint64_t>(n));
    Vec3 p;
    for (double& x : p) x = is_round ? random.normal() : random.uniform();
    cloud.points.push_back(p);
  }
  return cloud;
}

TEST(SmallestDimension, IsOneOnACurveTwoOnASurfaceAndNearThreeInSpace) {
  std::vector<Vec3> ring;
  for (int n = 0; n < 2000; ++n) ring.push_back({std::cos(n * 0.00314159), std::sin(n * 0.00314159), 0});
  EXPECT_NEAR(smallest_dimension(ring), 1, 0.02);
  // 600 pairs are counted at the smallest distance, to 4 % of their number.
  EXPECT_NEAR(
      smallest_dimension(synthetic::make_cloud({.shape = synthetic::CloudShape::sphere, .points = 10000}).points), 2,
      0.08);
  // The edge of the fog takes some neighbours away.
  for (const bool is_round : {false, true}) {
    EXPECT_GT(smallest_dimension(fog(1000, is_round).points), 2.7);
    EXPECT_LT(smallest_dimension(fog(20000, is_round).points), 3);
  }
}

TEST(SmallestDimension, SeesTheSurfaceBehindStrongNoise) {
  for (std::size_t shape = 0; shape < synthetic::names_of(synthetic::CloudShape{}).size(); ++shape)
    EXPECT_LT(
        smallest_dimension(synthetic::make_cloud(
                               {.shape = static_cast<synthetic::CloudShape>(shape), .points = 5000, .noise_percent = 2})
                               .points),
        2.5)
        << synthetic::names_of(synthetic::CloudShape{})[shape];
}

TEST(SmallestDimension, DoesNotTellFromAFewPoints) { EXPECT_EQ(smallest_dimension(fog(99, true).points), 0); }

bool fails(const Result& result) {
  return std::any_of(result.notes.begin(), result.notes.end(), [](const Note& note) {
    return note.code == "cloud.no_surface" && note.severity == Severity::failure;
  });
}

TEST(ReconstructCloud, FailsOnFogAndNotOnANoisyTornBody) {
  Options options;
  options.triangles = {320};
  EXPECT_TRUE(fails(reconstruct(fog(3000, false), options)));
  EXPECT_FALSE(fails(reconstruct(
      synthetic::make_cloud(
          {.shape = synthetic::CloudShape::vase, .points = 10000, .noise_percent = 0.5, .missing_percent = 20}),
      options)));
}

}  // namespace
}  // namespace dynasurf::cloud
