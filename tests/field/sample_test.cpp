#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "dynasurf/field/detail/field_view.hpp"
#include "dynasurf/field/vector_field.hpp"

#include "support/edge_maps.hpp"

namespace dynasurf::field {
namespace {

const Vec3 spacing{2, 3, 5};

/// u = (1 + 2x - y, z, x + y + z) in mm of the grid frame.
VectorField linear_field(int nx, int ny, int nz) {
  VectorField f(test::box(nx, ny, nz, spacing));
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const Vec3 p = centre_of(f.grid, {i, j, k});
        const std::size_t v = f.grid.index(i, j, k);
        f.x[v] = static_cast<float>(1 + 2 * p[0] - p[1]);
        f.y[v] = static_cast<float>(p[2]);
        f.z[v] = static_cast<float>(p.sum());
      }
  return f;
}

Vec3 expected(const Vec3& p) { return {1 + 2 * p[0] - p[1], p[2], p.sum()}; }

TEST(Sample, TrilinearIsExactOnALinearField) {
  const VectorField f = linear_field(6, 5, 4);
  for (double t : {0.0, 0.1, 0.5, 0.99, 1.0})
    for (const Vec3& p : {Vec3(10 * t, 12 * t, 15 * t), Vec3(10 * t, 12 - 12 * t, 7), Vec3(3.3, 4.1, 15 * t)})
      EXPECT_LT((sample(f, p, Sampling::trilinear) - expected(p)).norm(), 1e-12) << p.transpose();
}

TEST(Sample, NearestIsConstantInsideAVoxelAndJumpsAtItsWall) {
  const VectorField f = linear_field(6, 5, 4);
  const Vec3 centre = centre_of(f.grid, {2, 1, 3});
  for (const Vec3& shift : {Vec3(0.99, 1.49, -2.49), Vec3(-1, -1.5, 2.49), Vec3(0, 0, 0)})
    EXPECT_EQ(sample(f, centre + shift, Sampling::nearest), expected(centre));
  EXPECT_EQ(sample(f, centre + Vec3(1, 0, 0), Sampling::nearest), expected(centre_of(f.grid, {3, 1, 3})));
}

TEST(Sample, NeighbourAveragesTheVoxelsAhead) {
  const VectorField f = linear_field(6, 5, 4);
  const Vec3 p = centre_of(f.grid, {2, 2, 2});
  EXPECT_EQ(sample(f, p, Sampling::neighbour), expected(p)) << "at rest: the own voxel";
  // The mean of a linear field over a block is its value in the middle of the block.
  EXPECT_LT((sample(f, p, Sampling::neighbour, {3, -1, 0}) - expected(p + Vec3(1, -1.5, 0))).norm(), 1e-6);
  EXPECT_LT((sample(f, p, Sampling::neighbour, {-1, 1, 9}) - expected(p + Vec3(-1, 1.5, 2.5))).norm(), 1e-6);
}

TEST(Sample, NeighbourStopsAtTheBorderOfTheGrid) {
  const VectorField f = linear_field(6, 5, 4);
  const Vec3 p = centre_of(f.grid, {5, 0, 3});
  EXPECT_EQ(sample(f, p, Sampling::neighbour, {1, -1, 1}), expected(p));
}

TEST(Sample, OutsideTheGridIsTheNearestVoxel) {
  const VectorField f = linear_field(6, 5, 4);
  for (Sampling how : {Sampling::nearest, Sampling::trilinear, Sampling::neighbour}) {
    EXPECT_EQ(sample(f, {-1e300, -4, -9}, how), expected(Vec3::Zero()));
    EXPECT_EQ(sample(f, {1e300, 1e12, 99}, how), expected(centre_of(f.grid, {5, 4, 3})));
  }
}

TEST(Sample, WorksOnASingleVoxel) {
  VectorField f(test::box(1, 1, 1));
  f.x[0] = 1, f.y[0] = 2, f.z[0] = 3;
  for (Sampling how : {Sampling::nearest, Sampling::trilinear, Sampling::neighbour})
    EXPECT_EQ(sample(f, {0.4, -7, 0.1}, how, {1, 1, 1}), Vec3(1, 2, 3));
}

TEST(FieldView, TellsItsLongestVectorWhereverItIs) {
  for (const int width : {1, 4, 7}) {
    VectorField f(test::box(width, 3, 2));
    for (std::size_t v = 0; v < f.x.size(); ++v) {
      f = VectorField(f.grid);
      f.x[v] = -3, f.y[v] = 4, f.z[v] = 12;
      f.z[(v + 1) % f.x.size()] = 5;
      EXPECT_EQ(FieldView(f).largest(), 13) << width << ' ' << v;
      f.y[(v + 2) % f.x.size()] = std::numeric_limits<float>::quiet_NaN();
      EXPECT_TRUE(std::isnan(FieldView(f).largest())) << width << ' ' << v;
    }
    EXPECT_EQ(FieldView(VectorField(f.grid)).largest(), 0);
  }
}

}  // namespace
}  // namespace dynasurf::field
