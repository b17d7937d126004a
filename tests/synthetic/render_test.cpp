#include "dynasurf/synthetic/detail/render.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/detail/fill_mesh.hpp"
#include "dynasurf/synthetic/detail/solids.hpp"

#include "image_sums.hpp"
#include "mesh_checks.hpp"

namespace dynasurf::synthetic {
namespace {

Grid spect_grid(int n = 40, int slices = 23) {
  Grid g;
  g.dims = {n, n, slices};
  g.spacing = {2.87, 2.87, 5.74};
  return g;
}

/// Standard deviation of the image's mass along an axis, mm.
double spread_along(const Image& image, int axis) {
  double mass = 0, first = 0, second = 0;
  for (int k = 0; k < image.grid.dims[2]; ++k)
    for (int j = 0; j < image.grid.dims[1]; ++j)
      for (int i = 0; i < image.grid.dims[0]; ++i) {
        const double v = static_cast<double>(image(i, j, k)), x = centre_of(image.grid, {i, j, k})[axis];
        mass += v, first += v * x, second += v * x * x;
      }
  const double mean = first / mass;
  return std::sqrt(second / mass - mean * mean);
}

class PointSpread : public ::testing::TestWithParam<double> {};

TEST_P(PointSpread, HasTheWidthAskedForAlongEachAxis) {
  const double fwhm = GetParam(), own = 1.5;
  const Grid grid = spect_grid();
  // Off the centres of the voxels on purpose.
  const Vec3 centre = centre_of(grid, {20, 19, 11}) + Vec3(0.7, -1.1, 1.9);
  const auto spot = [&](const Vec3& p) { return std::exp(-(p - centre).squaredNorm() / (2 * own * own)); };
  const Box box{centre - Vec3::Constant(6 * own), centre + Vec3::Constant(6 * own)};
  const Image image = render(grid, spot, box, fwhm, sub_samples_for(grid, 1.2));
  for (int a = 0; a < 3; ++a) {
    const double spread = spread_along(image, a);
    EXPECT_NEAR(fwhm_of_sigma(std::sqrt(spread * spread - own * own)), fwhm, 0.005 * fwhm) << "axis " << a;
  }
  // What the camera sees in all is the activity there is.
  const double activity = std::pow(2 * M_PI * own * own, 1.5);
  EXPECT_NEAR(sum_of(image) * grid.voxel_volume_mm3(), activity, 0.005 * activity);
}

TEST_P(PointSpread, TurnsAnEdgeIntoAnErrorFunction) {
  const double fwhm = GetParam(), sigma = sigma_of_fwhm(fwhm);
  const Grid grid = spect_grid(24, 23);
  for (int axis = 0; axis < 3; ++axis) {
    const double edge = grid.spacing[axis] * 11.3;
    const auto half_space = [&](const Vec3& p) { return p[axis] <= edge ? 1.0 : 0.0; };
    const Image image =
        render(grid, half_space, {Vec3::Constant(-1000), Vec3::Constant(1000)}, fwhm, sub_samples_for(grid, 1.2));
    for (int n = 0; n < grid.dims[axis]; ++n) {
      Index3 v{12, 12, 11};
      v[axis] = n;
      const double expected = 0.5 * std::erfc((n * grid.spacing[axis] - edge) / sigma / std::sqrt(2.0));
      // An edge is only known to within half a sub-sample, 0.6 mm, which shifts the curve by at most this.
      EXPECT_NEAR(static_cast<double>(image(v[0], v[1], v[2])), expected, 0.6 * 0.3989 / sigma) << axis << " " << n;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Widths, PointSpread, ::testing::Values(8.0, 10.0, 12.0, 16.0));

TEST(Render, SeesActivityOutsideTheGridThroughThePointSpread) {
  Grid grid = spect_grid(10, 10);
  const auto beside = [](const Vec3& p) { return p[0] < -5 ? 1.0 : 0.0; };
  const Image image = render(grid, beside, {{-60, -60, -60}, {-5, 120, 120}}, 12, sub_samples_for(grid, 1.2));
  const double expected = 0.5 * std::erfc(5 / sigma_of_fwhm(12) / std::sqrt(2.0));
  EXPECT_NEAR(static_cast<double>(image(0, 5, 5)), expected, 0.05);
  EXPECT_GT(image(0, 5, 5), 0.1f);
}

TEST(Render, FillsPartialVolumesWithoutPointSpread) {
  Grid grid;
  grid.dims = {4, 4, 4};
  grid.spacing = {2, 3, 5};
  // Covers voxel 0 wholly and the lower two fifths of voxel 1 along k.
  const auto slab = [](const Vec3& p) { return p[2] < 4.5 ? 2.0 : 0.0; };
  const Image image = render(grid, slab, {{-100, -100, -100}, {100, 100, 4.5}}, 0, {3, 3, 5});
  EXPECT_FLOAT_EQ(image(1, 2, 0), 2.0f);
  EXPECT_FLOAT_EQ(image(1, 2, 1), 0.8f);
  EXPECT_FLOAT_EQ(image(1, 2, 2), 0.0f);
}

TEST(Render, KeepsTheVolumeOfASphereWithinHalfAPercent) {
  const Grid grid = spect_grid();
  const Vec3 centre = centre_of(grid, {20, 20, 11}) + Vec3(0.3, 0.9, 1.3);
  const auto ball = [&](const Vec3& p) { return (p - centre).norm() <= 25 ? 1.0 : 0.0; };
  const Box box{centre - Vec3::Constant(25), centre + Vec3::Constant(25)};
  const double truth = 4.0 / 3 * M_PI * 25 * 25 * 25;
  for (double fwhm : {0.0, 12.0}) {
    const Image image = render(grid, ball, box, fwhm, sub_samples_for(grid, 1.2));
    EXPECT_NEAR(sum_of(image) * grid.voxel_volume_mm3(), truth, 0.002 * truth) << fwhm;
  }
}

TEST(FillMesh, FillsABoxExactly) {
  Grid grid;
  grid.dims = {6, 6, 6};
  grid.spacing = {1, 1, 2};
  TriMesh box;
  for (int n = 0; n < 8; ++n) box.vertices.push_back({n & 1 ? 3.5 : 0.5, n & 2 ? 3.5 : 0.5, n & 4 ? 4.0 : 1.5});
  box.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  ASSERT_TRUE(closed_and_oriented(box));
  const Image image = mesh::fill_mesh(grid, box, {4, 4, 4});
  EXPECT_FLOAT_EQ(image(2, 2, 1), 0.75f);  // cell from 1 to 3, filled from 1.5
  EXPECT_FLOAT_EQ(image(2, 2, 2), 0.5f);   // cell from 3 to 5, filled to 4
  EXPECT_FLOAT_EQ(image(0, 2, 1), 0.0f);
  EXPECT_FLOAT_EQ(image(2, 2, 3), 0.0f);
  EXPECT_NEAR(sum_of(image) * grid.voxel_volume_mm3(), 3 * 3 * 2.5, 1e-6);
}

TEST(FillMesh, KeepsTheVolumeOfClosedMeshesWithinOnePerMille) {
  const Grid grid = spect_grid();
  TriMesh cup = surface(CylinderCup{30, 40});
  for (Vec3& p : cup.vertices) p += centre_of(grid, {20, 20, 11}) + Vec3(0, 0, -5);
  const double truth = signed_volume_ml(cup);
  EXPECT_NEAR(sum_of(mesh::fill_mesh(grid, cup, {5, 5, 5})) * grid.voxel_volume_mm3() / 1000, truth, 0.001 * truth);
}

TEST(FillMesh, AgreesWithTheAnalyticSolidVoxelByVoxel) {
  const Grid grid = spect_grid();
  const CylinderCup cup{30, 40};
  const Vec3 shift = centre_of(grid, {20, 20, 11}) + Vec3(0, 0, -5);
  TriMesh mesh = surface(cup);
  for (Vec3& p : mesh.vertices) p += shift;
  const Image from_mesh = mesh::fill_mesh(grid, mesh, {8, 8, 8});
  const Image from_solid = render(grid, [&](const Vec3& p) { return cup.contains(p - shift) ? 1.0 : 0.0; },
                                  {{0, 0, -60}, {200, 200, 200}}, 0, {8, 8, 8});
  double worst = 0;
  for (std::size_t v = 0; v < from_mesh.values.size(); ++v)
    worst = std::max(worst, std::abs(static_cast<double>(from_mesh.values[v] - from_solid.values[v])));
  // One layer of eight sub-samples along k at the lid, and the polygons of the rings.
  EXPECT_LT(worst, 0.13);
}

TEST(FillMesh, RefusesAnOpenMesh) {
  TriMesh open = surface(CylinderCup{30, 40});
  std::erase_if(open.triangles, [&](const auto& t) {
    return std::all_of(t.begin(), t.end(), [&](auto v) { return open.vertices[v][2] == 40; });
  });
  for (Vec3& p : open.vertices) p += Vec3(57, 57, 60);
  EXPECT_THROW(mesh::fill_mesh(spect_grid(), open, {2, 2, 2}), InputError);
}

TEST(Blur, SpreadsAPointByTheWidthAskedForWhateverTheVoxels) {
  const Grid grid = spect_grid();
  for (double fwhm : {3.0, 8.0, 14.0}) {
    Image point(grid);
    point(20, 20, 11) = 1000;
    const Image image = blur(point, fwhm);
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(fwhm_of_sigma(spread_along(image, a)), fwhm, 0.001 * fwhm) << a;
    EXPECT_NEAR(sum_of(image), 1000, 0.01);
  }
}

TEST(Blur, AddsVariancesWhenRepeated) {
  const Grid grid = spect_grid();
  Image point(grid);
  point(20, 20, 11) = 1000;
  const Image twice = blur(blur(point, 6), 8), once = blur(point, 10);
  for (std::size_t v = 0; v < once.values.size(); ++v) EXPECT_NEAR(twice.values[v], once.values[v], 1e-3);
}

TEST(Blur, LeavesConstantsAndZeroWidthAlone) {
  const Image even(spect_grid(8, 8), 5.0f);
  for (float v : blur(even, 20).values) EXPECT_NEAR(v, 5.0f, 1e-5);
  Image point(spect_grid(8, 8));
  point(4, 4, 4) = 1;
  EXPECT_EQ(blur(point, 0).values, point.values);
}

}  // namespace
}  // namespace dynasurf::synthetic
