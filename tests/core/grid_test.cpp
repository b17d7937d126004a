#include "dynasurf/core/grid.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf {
namespace {

Grid oblique_left_handed_grid() {
  Grid g;
  g.dims = {4, 5, 6};
  g.spacing = {2, 3, 5};
  g.origin = {10, -20, 30};
  g.direction << 0, 0, -1, 1, 0, 0, 0, 1, 0;
  return g;
}

TEST(Grid, RoundTripsBetweenIndexGridFrameAndWorld) {
  const Grid g = oblique_left_handed_grid();
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 4; ++i) {
        const Vec3 p = centre_of(g, {i, j, k});
        EXPECT_EQ(voxel_of(g, p), (Index3{i, j, k}));
        EXPECT_LT((to_grid(g, to_world(g, p)) - p).norm(), 1e-12);
      }
}

TEST(Grid, CellReachesHalfAVoxelToEachSide) {
  const Grid g = oblique_left_handed_grid();
  EXPECT_EQ(voxel_of(g, {0.99, -1.49, 2.49}), (Index3{0, 0, 0}));
  EXPECT_EQ(voxel_of(g, {1.01, -1.51, 2.51}), (Index3{1, -1, 1}));
}

TEST(Grid, CountsVoxelsInTheOrderOfMemory) {
  const Grid g = oblique_left_handed_grid();
  std::size_t n = 0;
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 4; ++i, ++n) {
        EXPECT_EQ(index_in(g.dims, {i, j, k}), n);
        EXPECT_EQ(voxel_in(g.dims, n), (Index3{i, j, k}));
      }
  EXPECT_EQ(size_of(g.dims), n);
  EXPECT_EQ(g.slice_size(), 20U);
}

TEST(Grid, CountsMoreVoxelsThanAnIntHolds) {
  if (sizeof(std::size_t) < 8) GTEST_SKIP() << "sizes have 32 bits";
  const Index3 large{2000, 2000, 2000};
  EXPECT_EQ(size_of(large), 8'000'000'000ULL);
  EXPECT_EQ(index_in(large, {1999, 1999, 1999}), 7'999'999'999ULL);
  EXPECT_EQ(voxel_in(large, 7'999'999'999ULL), (Index3{1999, 1999, 1999}));
}

TEST(Grid, KeepsFarPlacesWithinABox) {
  constexpr double far = 1e300;
  EXPECT_EQ(whole_within(2.9, 4), 2);
  EXPECT_EQ(whole_within(4, 4), 3);
  EXPECT_EQ(whole_within(far, 4), 3);
  EXPECT_EQ(whole_within(-far, 4), 0);
  EXPECT_EQ(whole_within(-0.5, 4), 0);
  EXPECT_EQ(whole_within(std::numeric_limits<double>::quiet_NaN(), 4), 0);
}

TEST(TriMesh, KeepsItsOutsideOutsideOnALeftHandedGrid) {
  const Grid g = oblique_left_handed_grid();
  ASSERT_LT(g.direction.determinant(), 0);
  const TriMesh triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const TriMesh moved = to_world(g, triangle);
  const auto normal = [](const TriMesh& m) {
    const auto& t = m.triangles[0];
    return Vec3((m.vertices[t[1]] - m.vertices[t[0]]).cross(m.vertices[t[2]] - m.vertices[t[0]]));
  };
  EXPECT_LT((normal(moved) - g.direction * normal(triangle)).norm(), 1e-12);
}

}  // namespace
}  // namespace dynasurf
