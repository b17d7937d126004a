#include "dynasurf/field/band.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/field/detail/field_view.hpp"
#include "dynasurf/field/gvf.hpp"

#include "support/edge_maps.hpp"

namespace dynasurf::field {
namespace {

using test::border_of;
using test::box;

/// A bumpy closed border of about half the box.
Image bumpy(const Grid& g) {
  const Vec3 half = Vec3(g.dims[0], g.dims[1], g.dims[2]).cwiseProduct(g.spacing) / 2;
  return border_of(g, [&](const Vec3& p) {
    const Vec3 q = p.cwiseQuotient(half) - Vec3(0.1, -0.1, 0.05);
    return q.norm() < 0.5 + 0.1 * std::sin(4 * q[0] + 1) * std::cos(3 * q[1]) + 0.1 * q[2];
  });
}

Image sphere(int n, double radius) {
  return border_of(box(n, n, n), [&](const Vec3& p) { return p.norm() <= radius; });
}

std::vector<Index3> voxels_of(const Image& f) {
  std::vector<Index3> list;
  for (int k = 0; k < f.grid.dims[2]; ++k)
    for (int j = 0; j < f.grid.dims[1]; ++j)
      for (int i = 0; i < f.grid.dims[0]; ++i)
        if (f(i, j, k) == 1) list.push_back({i, j, k});
  return list;
}

/// |u - full| / |full| over the voxels of the band.
double apart(const BandField& band, const VectorField& full) {
  double d = 0, n = 0;
  const Index3& dims = full.grid.dims;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i) {
        if (!band.is_in_band(i, j, k)) continue;
        const std::size_t v = full.grid.index(i, j, k);
        const Vec3 u(full.x[v], full.y[v], full.z[v]);
        d += (band.at(i, j, k) - u).squaredNorm();
        n += u.squaredNorm();
      }
  return std::sqrt(d / n);
}

VectorField full_field(const Image& f, double mu) {
  return flow_field(f, SteadyGvf{.mu = mu, .tolerance = 1e-5}).field;
}

TEST(BandGvf, EqualsTheFullFieldNearTheBorder) {
  for (double mu : {0.05, 0.2, 2.0}) {
    const Image f = sphere(80, 24);
    const BandResult r = band_field(f, BandGvf{.mu = mu});
    EXPECT_LT(r.field.voxels_in_band(), f.grid.size() / 2);
    EXPECT_TRUE(r.notes.empty());
    EXPECT_LT(r.error, 1e-3);
    EXPECT_LT(apart(r.field, full_field(f, mu)), 3e-3) << mu;  // 1e-3 for the cycles and as much for coarse cells
  }
}

TEST(BandGvf, IsNearerToTheFullFieldTheWiderItIs) {
  const Image f = bumpy(box(72, 64, 66));
  const VectorField full = full_field(f, 0.2);
  double before = 1;
  for (int reach : {1, 8, 64}) {
    const double now = apart(band_field(f, BandGvf{.tolerance = 1e-5, .reach_voxels = reach}).field, full);
    EXPECT_LT(now, 0.7 * before) << reach;
    before = now;
  }
  EXPECT_LT(before, 1e-4) << "a band of the whole box is the full field";
}

TEST(BandGvf, WorksOnAnySizeSpacingAndMap) {
  std::uint32_t seed = 1;
  for (const Grid& g : {box(1, 1, 2), box(2, 2, 2), box(3, 5, 17), box(29, 31, 1), box(1, 30, 41), box(300, 2, 3),
                        box(17, 33, 31), box(40, 24, 9, {1, 1, 5}), box(21, 22, 23, {0.1, 5, 1})})
    for (double mu : {1e-3, 1.0, 100.0}) {
      const Image f = test::noise(g, ++seed);  // data everywhere: the band is the box
      const BandResult r = band_field(f, BandGvf{.mu = mu, .tolerance = 1e-4});
      EXPECT_LT(apart(r.field, full_field(f, mu)), 2e-4) << g.dims[0] << "x" << g.dims[1] << "x" << g.dims[2];
    }
}

TEST(BandGvf, FollowsAnisotropicSpacing) {
  const Image f = bumpy(box(64, 64, 30, {1, 1, 2.5}));
  EXPECT_LT(apart(band_field(f, BandGvf{}).field, full_field(f, 0.2)), 4e-3);
}

TEST(BandGvf, OfAListOfVoxelsIsThatOfTheirMap) {
  for (const Image& f : {bumpy(box(50, 41, 37)), bumpy(box(61, 70, 1))}) {
    const BandResult a = band_field(f, BandGvf{}), b = band_field(f.grid, voxels_of(f), BandGvf{});
    EXPECT_EQ(a.field.voxels_in_band(), b.field.voxels_in_band());
    EXPECT_EQ(dense_field(a.field).x, dense_field(b.field).x);
  }
}

TEST(BandGvf, ItsCostFollowsTheSurfaceNotTheBox) {
  // The same sphere in boxes of 8 times the volume: nothing but the table of bricks grows.
  const auto result = [](int n, double radius) {
    const Image f = sphere(64, 20);
    std::vector<Index3> list = radius == 20 ? voxels_of(f) : voxels_of(sphere(128, radius));
    return band_field(box(n, n, n), list, BandGvf{}).field;
  };
  const BandField small = result(64, 20), roomy = result(512, 20), large = result(128, 40);
  EXPECT_EQ(roomy.voxels_in_band(), small.voxels_in_band());
  EXPECT_LT(roomy.bytes(), 3 * small.bytes());
  const double growth = double(large.voxels_in_band()) / double(small.voxels_in_band());
  EXPECT_LT(growth, 5.0) << "twice the radius is 4 times the area and 8 times the volume";
}

TEST(BandGvf, IsReadLikeADenseField) {
  const Image f = bumpy(box(40, 33, 35, {1, 2, 1}));
  const BandField band = band_field(f, BandGvf{}).field;
  const VectorField dense = dense_field(band);
  for (const Vec3& p : {Vec3(3.3, 5.1, 7.7), Vec3(20.2, 30.9, 11.5), Vec3(-4, 200, 3), Vec3(39, 64, 34)})
    for (Sampling how : {Sampling::nearest, Sampling::trilinear, Sampling::neighbour})
      EXPECT_LT((sample(band, p, how, Vec3(1, -1, 0)) - sample(dense, p, how, Vec3(1, -1, 0))).norm(), 1e-6);
}

TEST(BandGgvf, EqualsTheFullFieldNearTheBorder) {
  for (double k : {0.05, 0.1, 0.5}) {
    for (const Image& f : {sphere(72, 24), bumpy(box(64, 50, 30, {1, 1, 2.5}))}) {
      const BandResult r = band_field(f, BandGgvf{.k = k});
      EXPECT_TRUE(r.notes.empty());
      EXPECT_LT(apart(r.field, flow_field(f, SteadyGgvf{.k = k, .tolerance = 1e-5}).field), 5e-3) << k;
      const BandResult listed = band_field(f.grid, voxels_of(f), BandGgvf{.k = k});
      EXPECT_EQ(dense_field(r.field).x, dense_field(listed.field).x);
    }
  }
  EXPECT_EQ(band_field(Image(box(20, 20, 20), 0.5f), BandGgvf{}).field.voxels_in_band(), 0u);
}

TEST(BandGgvf, IsAsFarFromGvfAsTheFullFields) {
  const Image f = sphere(64, 20);
  EXPECT_GT(apart(band_field(f, BandGgvf{}).field, full_field(f, 0.2)), 0.05);
}

TEST(BandGvf, IsAChoiceAmongTheFields) {
  const Image f = bumpy(box(40, 33, 35));
  for (const FieldOptions& o : {FieldOptions(BandGvf{}), FieldOptions(BandGgvf{})}) {
    const FlowResult r = flow_field(f, o);
    ASSERT_TRUE(r.error.has_value());
    EXPECT_LT(*r.error, 1e-3);
    EXPECT_GT(r.iterations, 0);
    const BandField band =
        std::holds_alternative<BandGvf>(o) ? band_field(f, BandGvf{}).field : band_field(f, BandGgvf{}).field;
    EXPECT_EQ(r.field.y, dense_field(band).y);
  }
}

TEST(BandField, TellsItsLongestVector) {
  const Image f = bumpy(box(60, 53, 45, {1, 2, 1}));
  const BandField band = band_field(f, BandGvf{}).field;
  const VectorField dense = dense_field(band);
  EXPECT_NEAR(FieldView(band).largest(), FieldView(dense).largest(), 1e-6);
  EXPECT_EQ(FieldView(band).grid().dims, f.grid.dims);
  EXPECT_LT((FieldView(band).at(3, 4, 5) - FieldView(dense).at(3, 4, 5)).norm(), 1e-6);
}

TEST(BandGvf, HasTheSameBytesForAnyNumberOfThreads) {
  const Image f = bumpy(box(70, 45, 51));
  VectorField one;
  {
    const ThreadLimit limit(1);
    one = dense_field(band_field(f, BandGvf{}).field);
  }
  const ThreadLimit limit(3);
  const VectorField three = dense_field(band_field(f, BandGvf{}).field);
  EXPECT_EQ(three.x, one.x);
  EXPECT_EQ(three.z, one.z);
}

TEST(BandGvf, IsZeroWithoutABorder) {
  const BandResult r = band_field(Image(box(20, 20, 20), 0.5f), BandGvf{});
  EXPECT_EQ(r.field.voxels_in_band(), 0u);
  EXPECT_EQ(r.field.at(3, 4, 5), Vec3(0, 0, 0));
  EXPECT_EQ(r.error, 0);
  EXPECT_EQ(dense_field(band_field(Image(box(1, 1, 1), 1.0f), BandGvf{}).field).x[0], 0);
}

TEST(BandGvf, SaysWhenItStoppedShortOfTheTolerance) {
  const BandResult r = band_field(bumpy(box(30, 30, 30)), BandGvf{.tolerance = 1e-5, .most_cycles = 1});
  ASSERT_EQ(r.notes.size(), 1u);
  EXPECT_EQ(r.notes[0].code, "band.tolerance_missed");
}

TEST(BandGvf, RefusesBadInput) {
  EXPECT_THROW(band_field(Image{}, BandGvf{}), InputError);
  EXPECT_THROW(band_field(Image(box(3, 3, 3)), BandGvf{.mu = 0}), OptionError);
  EXPECT_THROW(band_field(Image(box(3, 3, 3)), BandGgvf{.k = 0}), OptionError);
  Image f(box(20, 20, 20));
  f(10, 10, 10) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(band_field(f, BandGvf{}), InputError);
  f(10, 10, 10) = 1e30f;
  EXPECT_THROW(band_field(f, BandGvf{}), InputError);
  const std::vector<Index3> outside{{1, 1, 20}};
  EXPECT_THROW(band_field(f.grid, outside, BandGvf{}), InputError);
  EXPECT_THROW(band_field(box(3, 3, 3, {1, 0, 1}), {}, BandGvf{}), InputError);
}

TEST(BandGvf, StopsOnRequest) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(band_field(bumpy(box(24, 24, 24)), BandGvf{}, Progress{{}, source.get_token()}), Cancelled);
}

}  // namespace
}  // namespace dynasurf::field
