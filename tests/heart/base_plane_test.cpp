#include "dynasurf/heart/base_plane.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::heart {
namespace {

const LvShell heart{{60, 60, 62}, {0, 0, 1}, 30, 48, 26};

/// A blurred wall: bright near the middle surface of `heart`, ending smoothly at a plane.
Image walled(const BasePlane& base) {
  Grid grid;
  grid.dims = {41, 41, 41};
  grid.spacing = {3, 3, 3};
  Image image(grid);
  for (int k = 0; k < 41; ++k)
    for (int j = 0; j < 41; ++j)
      for (int i = 0; i < 41; ++i) {
        const Vec3 p = centre_of(grid, {i, j, k}), d = p - heart.centre;
        const double level = std::sqrt((d[0] * d[0] + d[1] * d[1]) / (30.0 * 30) + d[2] * d[2] / (48.0 * 48));
        const double away = (level - 1) * 30;
        const double wall = std::exp(-away * away / (2 * 6.0 * 6.0));
        image(i, j, k) = static_cast<float>(0.1 + 0.9 * wall * 0.5 * std::erfc(base.height(p) / (5 * std::sqrt(2))));
      }
  return image;
}

TEST(BasePlane, LiesWhereTheWallEndsToAFractionOfAVoxel) {
  for (const double height : {20.0, 26.3, 31.7}) {
    const BasePlane truth{heart.centre + height * heart.axis, Vec3::UnitZ()};
    const auto found = find_base_plane(look_at_wall(walled(truth), heart));
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->point[2], truth.point[2], 1.0) << "a third of a voxel";
    EXPECT_GT(found->normal[2], std::cos(2 * std::numbers::pi / 180));
    EXPECT_GT(found->seen, 0.9);
  }
}

TEST(BasePlane, MayLean) {
  const BasePlane truth{heart.centre + 24 * heart.axis, Vec3(0.2, 0, 1).normalized()};
  const auto found = find_base_plane(look_at_wall(walled(truth), heart));
  ASSERT_TRUE(found);
  const double lean = std::atan2(found->normal[0], found->normal[2]), true_lean = std::atan2(0.2, 1.0);
  EXPECT_NEAR(lean, true_lean, 0.3 * true_lean) << "the tilt is held near square on purpose";
  EXPECT_NEAR(found->normal[1], 0, 0.02);
}

TEST(BasePlane, IsAbsentWhereTheWallDoesNotEnd) {
  EXPECT_FALSE(find_base_plane(look_at_wall(Image(walled({}).grid, 1.0F), heart)));
}

TEST(BasePlane, IsLaidThroughWhatTheVolumeShowsAndSaysWhatItDoesNot) {
  const BasePlane truth{heart.centre + 26 * heart.axis, Vec3(0.15, 0, 1).normalized()};
  const Image whole = walled(truth);
  Image cut = whole;  // ends at 87 mm, below the higher part of the base
  cut.grid.dims[2] = 30;
  cut.values.resize(cut.grid.size());
  const auto all = find_base_plane(look_at_wall(whole, heart)), part = find_base_plane(look_at_wall(cut, heart));
  ASSERT_TRUE(all && part);
  EXPECT_EQ(all->cut, 0);
  EXPECT_GT(part->cut, 0.2);
  EXPECT_NEAR(part->point[2], truth.point[2], 2.5) << "a voxel";
}

TEST(BasePlane, ALowerLevelLiesHigher) {
  const Image image = walled({heart.centre + 26 * heart.axis, Vec3::UnitZ()});
  const auto half = find_base_plane(look_at_wall(image, heart), 0.5),
             third = find_base_plane(look_at_wall(image, heart), 0.35);
  ASSERT_TRUE(half && third);
  // The wall ends like an error function of 5 mm: 0.35 of it is reached 0.385 deviations above the half.
  EXPECT_NEAR(third->point[2] - half->point[2], 0.385 * 5, 0.5);
}

/// A wall whose end goes down by 12 mm and back while it brightens by `by`.
std::vector<Image> beating(int gates, double by) {
  std::vector<Image> images;
  for (int g = 0; g < gates; ++g) {
    const double systole = (1 - std::cos(2 * std::numbers::pi * g / gates)) / 2;
    images.push_back(walled({heart.centre + (28 - 12 * systole) * heart.axis, Vec3::UnitZ()}));
    for (float& v : images.back().values) v *= 1 + by * systole;
  }
  return images;
}

TEST(OutwardMotion, IsThatOfTheWallsEndWhileTheWallBrightens) {
  EXPECT_NEAR(*outward_motion_mm(beating(8, 0.3), heart), -12, 1);
  EXPECT_NEAR(*outward_motion_mm(beating(8, -0.3), heart), 12, 1);
  EXPECT_FALSE(outward_motion_mm(beating(5, 0.3), heart)) << "too few gates";
}

TEST(PlaneCycle, FollowsAWaveAndCorrectsTheGateThatDoesNotFitIn) {
  std::vector<std::optional<BasePlane>> planes;
  const auto height = [](int g) { return 5 * std::cos(2 * std::numbers::pi * g / 8); };
  for (int g = 0; g < 8; ++g) planes.push_back(BasePlane{{0, 0, height(g)}, Vec3::UnitZ()});
  planes[3]->point[2] += 25;
  const auto cycle = smooth_over_cycle(planes, Vec3::UnitZ());
  ASSERT_TRUE(cycle);
  for (int g = 0; g < 8; ++g) {
    EXPECT_NEAR(cycle->planes[static_cast<std::size_t>(g)].point[2], height(g), 0.5) << g;
    EXPECT_EQ(cycle->outlier[static_cast<std::size_t>(g)], g == 3);
  }
}

TEST(PlaneCycle, FillsAGateWithoutAPlaneButNotHalfOfThem) {
  std::vector<std::optional<BasePlane>> planes(8, BasePlane{{1, 2, 7}, Vec3::UnitZ()});
  planes[2] = std::nullopt;
  const auto cycle = smooth_over_cycle(planes, Vec3::UnitZ());
  ASSERT_TRUE(cycle);
  EXPECT_TRUE(cycle->outlier[2]);
  EXPECT_LT((cycle->planes[2].point - Vec3(1, 2, 7)).norm(), 1e-3);
  for (int g = 0; g < 5; ++g) planes[static_cast<std::size_t>(g)] = std::nullopt;
  EXPECT_FALSE(smooth_over_cycle(planes, Vec3::UnitZ()));
}

TEST(FlattenAbove, LeavesTheVolumeBelowThePlaneClosed) {
  // Of a sphere of radius 1 a plane at height h leaves pi (2 + 3h - h^3) / 3.
  const double h = 0.3;
  const TriMesh cut = flatten_above(mesh::icosphere(5), {{0, 0, h}, Vec3::UnitZ()});
  EXPECT_TRUE(mesh::topology(cut).closed());
  EXPECT_TRUE(mesh::topology(cut).oriented());
  const double expected = std::numbers::pi * (2 + 3 * h - h * h * h) / 3;
  EXPECT_NEAR(mesh::volume_mm3(cut), expected, 0.005 * expected) << "what the corners of the triangles leave";
  for (const Vec3& p : cut.vertices) EXPECT_LE(p[2], h + 1e-12);
}

TEST(FlattenAbove, DoesNothingToASurfaceBelowThePlane) {
  const TriMesh sphere = mesh::icosphere(2);
  EXPECT_EQ(flatten_above(sphere, {{0, 0, 2}, Vec3::UnitZ()}).vertices, sphere.vertices);
}

}  // namespace
}  // namespace dynasurf::heart
