#include "dynasurf/ventricle/detail/settle.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/detail/noise.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double radius_mm = 25, sigma_mm = 5;
const Vec3 middle{45, 45, 45};

/// A ball whose brightness falls like a blurred step: steepest exactly at its radius, all around.
Image soft_ball(double inside, double outside, double slice_mm = 3) {
  Image image(Grid{.dims = {31, 31, static_cast<int>(90 / slice_mm) + 1}, .spacing = {3, 3, slice_mm}});
  for (int k = 0; k < image.grid.dims[2]; ++k)
    for (int j = 0; j < 31; ++j)
      for (int i = 0; i < 31; ++i) {
        const double r = (centre_of(image.grid, {i, j, k}) - middle).norm();
        const double share = 0.5 * std::erfc((r - radius_mm) / (std::sqrt(2.0) * sigma_mm));
        image(i, j, k) = static_cast<float>(outside + share * (inside - outside));
      }
  return image;
}

/// A sphere about the ball, off by some mm and by as much again from vertex to vertex.
TriMesh sphere(double off_mm, double rough_mm = 0) {
  TriMesh mesh = mesh::icosphere(3);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    mesh.vertices[v] = middle + (radius_mm + off_mm + (v % 2 == 0 ? rough_mm : -rough_mm)) * mesh.vertices[v];
  return mesh;
}

double off_mm(const Vec3& p) { return (p - middle).norm() - radius_mm; }

double largest_error_mm(const TriMesh& mesh) {
  double largest = 0;
  for (const Vec3& p : mesh.vertices) largest = std::max(largest, std::abs(off_mm(p)));
  return largest;
}

const Vec3 no_base = Vec3::Zero();

TEST(Settle, PutsASphereOnTheSteepestSlopeOfBrightAndOfDarkBalls) {
  for (const double inside : {100.0, 0.0})
    for (const double off : {-3.0, 2.0, 3.5})
      // A fifth of a voxel: 0.36 mm where a cubic interpolation is at its worst, and roughness that a round halves.
      EXPECT_LT(largest_error_mm(settle_on_slope(sphere(off, 0.4), soft_ball(inside, 100 - inside), no_base, {})), 0.6)
          << inside << ", " << off;
}

TEST(Settle, LosesATenthOfASliceWhereSlicesAreAsThickAsTheBlur) {
  const TriMesh end = settle_on_slope(sphere(3), soft_ball(100, 0, 6), no_base, {});
  double sum = 0;
  for (const Vec3& p : end.vertices) sum += std::abs(off_mm(p));
  EXPECT_LT(sum / static_cast<double>(end.vertices.size()), 0.6);
}

TEST(Settle, ComesNearerWithEveryRound) {
  const Image ball = soft_ball(100, 0);
  double before = 3;
  for (const int rounds : {1, 2}) {
    const double now = largest_error_mm(settle_on_slope(sphere(3), ball, no_base, {.rounds = rounds}));
    EXPECT_LT(now, before);
    before = now;
  }
}

TEST(Settle, WithoutRoundsLeavesTheSurfaceAlone) {
  const TriMesh start = sphere(2);
  EXPECT_EQ(settle_on_slope(start, soft_ball(100, 0), no_base, {.rounds = 0}).vertices, start.vertices);
}

TEST(Settle, LeavesTheLidThatFacesTheBase) {
  const TriMesh start = sphere(3);
  const TriMesh end = settle_on_slope(start, soft_ball(100, 0), Vec3::UnitZ(), {});
  for (std::size_t v = 0; v < start.vertices.size(); ++v) {
    const double height = (start.vertices[v] - middle).normalized()[2];
    if (height > 0.6) {
      EXPECT_EQ(end.vertices[v], start.vertices[v]);
    }
    if (height < 0.2) {
      EXPECT_LT(std::abs(off_mm(end.vertices[v])), 0.45);
    }
  }
}

TEST(Settle, MovesAsTheSurfaceDoesWhereTheImageShowsNothing) {
  Image ball = soft_ball(100, 0);
  for (std::size_t v = 0; v < ball.values.size(); ++v)
    if (v % 31 > 22) ball.values[v] = 50;  // more than 24 mm to the right of the middle
  const TriMesh end = settle_on_slope(sphere(3), ball, no_base, {});
  for (const Vec3& p : end.vertices)
    if ((p - middle)[0] > 0.97 * radius_mm) {
      EXPECT_LT(off_mm(p), 2);
    }
}

TEST(Settle, DoesNotFollowTheRimOfADefectIntoTheCavity) {
  // A dark ball in a bright shell that lacks a sector: the inner surface there has nothing to settle on, and what is
  // left of the shell shows slopes at the rim that lead around its corner.
  Image shell = soft_ball(0, 100);
  for (int k = 0; k < shell.grid.dims[2]; ++k)
    for (int j = 0; j < 31; ++j)
      for (int i = 0; i < 31; ++i) {
        const Vec3 p = centre_of(shell.grid, {i, j, k}) - middle;
        const double gone = std::atan2(p[1], p[0]);
        const double share = 0.5 * std::erfc((p.norm() - 1.5 * radius_mm) / (std::sqrt(2.0) * sigma_mm));
        const double edge = 0.5 * (std::erf((std::abs(gone) - 0.65) * p.norm() / 4) + 1);
        shell(i, j, k) = static_cast<float>(shell(i, j, k) * share * (0.05 + 0.95 * edge));
      }
  const TriMesh end = settle_on_slope(sphere(0), shell, no_base, {});
  double most_inwards = 0;
  for (const Vec3& p : end.vertices)
    if (std::abs(std::atan2(p[1] - middle[1], p[0] - middle[0])) < 0.5)
      most_inwards = std::min(most_inwards, off_mm(p));
  EXPECT_GT(most_inwards, -1);
}

TEST(Settle, AveragesNoiseAway) {
  const Image ball = synthetic::add_gaussian_noise(soft_ball(100, 0), 1, 7, 0);
  const TriMesh end = settle_on_slope(sphere(2), ball, no_base, {});
  double sum = 0;
  for (const Vec3& p : end.vertices) sum += off_mm(p) * off_mm(p);
  // The ball changes by 8 over a millimetre at its steepest, by 6 at a voxel's distance from there. A quarter voxel.
  EXPECT_LT(std::sqrt(sum / static_cast<double>(end.vertices.size())), 0.75);
}

TEST(Settle, StaysInAnImageWithoutSlopes) {
  const TriMesh start = sphere(1);
  EXPECT_EQ(settle_on_slope(start, soft_ball(50, 50), no_base, {}).vertices, start.vertices);
}

}  // namespace
}  // namespace dynasurf::ventricle
