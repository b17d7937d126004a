#include <numeric>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/detail/fill_mesh.hpp"
#include "dynasurf/mesh/marching.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::mesh {
namespace {

Grid grid_of(const Index3& dims, const Vec3& spacing) {
  Grid grid;
  grid.dims = dims, grid.spacing = spacing;
  return grid;
}

TriMesh box(const Vec3& low, const Vec3& high) {
  TriMesh mesh;
  for (int n = 0; n < 8; ++n)
    mesh.vertices.emplace_back(n & 1 ? high[0] : low[0], n & 2 ? high[1] : low[1], n & 4 ? high[2] : low[2]);
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TriMesh ball(const Vec3& centre, double radius, int level = 3) {
  TriMesh mesh = icosphere(level);
  for (Vec3& p : mesh.vertices) p = centre + radius * p;
  return mesh;
}

double volume_in(const Image& parts) {
  return std::accumulate(parts.values.begin(), parts.values.end(), 0.0) * parts.grid.voxel_volume_mm3();
}

TEST(VoxelParts, OfABoxAreTheProductsOfItsOverlaps) {
  const Grid grid = grid_of({4, 4, 4}, {2, 3, 4});
  const Image parts = voxel_parts(grid, box({0.5, 1, 2}, {4.2, 6.5, 11}));
  const double x[] = {0.25, 1, 0.6, 0}, y[] = {0.5 / 3, 1, 2.0 / 3, 0}, z[] = {0, 1, 1, 0.25};
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) EXPECT_NEAR(parts(i, j, k), x[i] * y[j] * z[k], 1e-7) << i << j << k;
}

TEST(VoxelParts, OfABoxOnTheWallsBetweenVoxelsAreNoneOrAll) {
  const Image parts = voxel_parts(grid_of({3, 3, 3}, {1, 1, 1}), box({0.5, 0.5, 0.5}, {1.5, 1.5, 2.5}));
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) EXPECT_EQ(parts(i, j, k), i == 1 && j == 1 && k > 0 ? 1 : 0);
}

TEST(VoxelParts, AddUpToTheVolumeOfTheMesh) {
  for (const int level : {0, 2, 4}) {
    const TriMesh mesh = ball({20.3, 19.1, 31.7}, 14.9, level);
    const Image parts = voxel_parts(grid_of({14, 14, 11}, {3, 2.9, 6}), mesh);
    // Parts are single precision.
    EXPECT_NEAR(volume_in(parts) / volume_mm3(mesh), 1, 1e-7) << level;
  }
}

TEST(VoxelParts, OutsideTheGridChangeNothingInside) {
  const TriMesh mesh = ball({9, 9, 9}, 8.2);
  const Image all = voxel_parts(grid_of({19, 19, 19}, {1, 1, 1}), mesh);
  const Grid window = grid_of({5, 6, 4}, {1, 1, 1});
  const Vec3 shift(7, 6, 8);
  TriMesh moved = mesh;
  for (Vec3& p : moved.vertices) p -= shift;
  const Image part = voxel_parts(window, moved);
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 5; ++i) EXPECT_NEAR(part(i, j, k), all(i + 7, j + 6, k + 8), 1e-6);
}

TEST(VoxelParts, AreWhatFineSamplesComeTo) {
  const Grid grid = grid_of({12, 12, 12}, {3, 3, 3});
  const TriMesh mesh = ball({16.1, 17.2, 15.9}, 12, 2);
  const Image exact = voxel_parts(grid, mesh), sampled = fill_mesh(grid, mesh, {40, 40, 1});
  for (std::size_t v = 0; v < grid.size(); ++v) EXPECT_NEAR(exact.values[v], sampled.values[v], 0.02);
}

TEST(VoxelParts, AreNoneOfAMeshBesideTheGrid) {
  for (const Vec3& where : {Vec3(-50, 5, 5), Vec3(5, 50, 5), Vec3(5, 5, 50), Vec3(5, 5, -50)}) {
    const Image parts = voxel_parts(grid_of({10, 10, 10}, {1, 1, 1}), ball(where, 20));
    EXPECT_EQ(volume_in(parts), 0) << where.transpose();
  }
}

TEST(VoxelParts, NeedAClosedSurfaceThatFacesOneWay) {
  const Grid grid = grid_of({4, 4, 4}, {1, 1, 1});
  TriMesh open = box({0, 0, 0}, {2, 2, 2}), turned = open;
  open.triangles.pop_back();
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_THROW(voxel_parts(grid, open), InputError);
  EXPECT_THROW(voxel_parts(grid, turned), InputError);
  EXPECT_THROW(voxel_parts(grid, TriMesh()), InputError);
}

}  // namespace
}  // namespace dynasurf::mesh
