#include "dynasurf/mesh/shapes.hpp"

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/smooth.hpp"

#include "support/shapes.hpp"

namespace dynasurf::mesh {
namespace {

using namespace test_shapes;

TEST(Icosphere, HasTheCountsOfTheThesis) {
  for (int level = 0; level <= 5; ++level) {
    const TriMesh m = icosphere(level);
    const std::size_t four_to_level = std::size_t{1} << (2 * level);
    EXPECT_EQ(m.vertices.size(), 10 * four_to_level + 2);
    EXPECT_EQ(m.triangles.size(), 20 * four_to_level);
    for (const Vec3& p : m.vertices) EXPECT_NEAR(p.norm(), 1, 1e-15);
  }
}

TEST(Icosphere, IsAClosedOrientedSphere) {
  for (int level = 0; level <= 5; ++level) {
    const Topology t = topology(icosphere(level));
    EXPECT_EQ(t.euler, 2);
    EXPECT_EQ(t.components, 1);
    EXPECT_TRUE(t.closed());
    EXPECT_TRUE(t.oriented());
  }
}

TEST(Icosphere, FillsTheKnownShareOfTheSphere) {
  const double ball = 4 * std::numbers::pi / 3;
  const double expected[] = {0.96616, 0.99139, 0.99784};  // printed to 5 digits
  for (int level = 2; level <= 4; ++level) EXPECT_NEAR(volume_mm3(icosphere(level)) / ball, expected[level - 2], 5e-6);
}

TEST(Icosphere, KeepsTheVerticesOfTheCoarserLevelAsItsFirst) {
  for (int level = 0; level < 5; ++level) {
    const TriMesh coarse = icosphere(level), fine = icosphere(level + 1);
    for (std::size_t v = 0; v < coarse.vertices.size(); ++v) EXPECT_EQ(coarse.vertices[v], fine.vertices[v]);
  }
}

TEST(Icosphere, IsConvexAtEveryVertex) {
  for (int level = 0; level <= 4; ++level)
    for (double deficit : angle_deficits(icosphere(level))) EXPECT_GT(deficit, 0);
  // The deficits of level 2 that show the tolerance 0.2 to be in radians.
  const std::vector<double> d = angle_deficits(icosphere(2));
  EXPECT_NEAR(*std::min_element(d.begin(), d.end()), 0.069, 5e-4);
  EXPECT_NEAR(*std::max_element(d.begin(), d.end()), 0.082, 5e-4);
}

TEST(Icosphere, RefusesLevelsOutOfRange) {
  EXPECT_THROW(icosphere(-1), OptionError);
  EXPECT_THROW(icosphere(10), OptionError);
}

Grid hebron_grid() {
  Grid g;
  g.dims = {64, 64, 23};
  g.spacing = {2.87, 2.87, 5.74};
  return g;
}

TEST(Place, PutsTheEllipsoidAroundTheBoxOfTheData) {
  Image data(hebron_grid());
  data(10, 20, 5) = data(19, 23, 9) = 1;
  const TriMesh unit{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 0}}, {}};
  const TriMesh m = place(unit, data, {.scale = 2});
  const Vec3 centre(14.5 * 2.87, 21.5 * 2.87, 7 * 5.74);  // the box holds 10 x 4 x 5 whole voxels
  EXPECT_LT((m.vertices[4] - centre).norm(), 1e-12);
  EXPECT_LT((m.vertices[0] - centre - Vec3(10 * 2.87, 0, 0)).norm(), 1e-12);
  EXPECT_LT((m.vertices[2] - centre - Vec3(0, 4 * 2.87, 0)).norm(), 1e-12);
  EXPECT_LT((m.vertices[3] - centre + Vec3(0, 0, 5 * 5.74)).norm(), 1e-12);
}

TEST(Place, CentresOnTheMassWhenAsked) {
  Image data(hebron_grid());
  data(10, 20, 5) = data(11, 20, 5) = data(30, 20, 5) = 1;
  const TriMesh m = place({{{0, 0, 0}}, {}}, data, {.centre_of_mass = true});
  EXPECT_LT((m.vertices[0] - Vec3(17 * 2.87, 20 * 2.87, 5 * 5.74)).norm(), 1e-12);
}

TEST(Place, LeavesEveryVoxelOfARoundBodyInside) {
  // A cup: the widest part of the box is filled at its top rim, which is the hardest case of the four.
  const Grid g = hebron_grid();
  const Vec3 c(90, 92, 62);
  const std::vector<Inside> bodies = {
      [&](const Vec3& p) { return (p - c).norm() < 30; },
      [&](const Vec3& p) { return ((p - c).cwiseQuotient(Vec3(40, 25, 50))).norm() < 1; },
      [&](const Vec3& p) { return (p - c).head<2>().norm() < 35 && std::abs(p[2] - c[2]) < 40; },
      [&](const Vec3& p) {
        return p == centre_of(g, {4, 5, 6});
      }};
  for (const Inside& body : bodies) {
    const Image data = filled(g, body);
    ASSERT_GT(count_non_zero(data), 0U);
    const TriMesh m = place(icosphere(3), data, {});
    // An icosphere is convex, so a point is inside when it is behind every triangle.
    for (int k = 0; k < g.dims[2]; ++k)
      for (int j = 0; j < g.dims[1]; ++j)
        for (int i = 0; i < g.dims[0]; ++i) {
          if (data(i, j, k) == 0) continue;
          const Vec3 p = centre_of(g, {i, j, k});
          for (const auto& t : m.triangles) {
            const Vec3 normal = (m.vertices[t[1]] - m.vertices[t[0]]).cross(m.vertices[t[2]] - m.vertices[t[0]]);
            ASSERT_LT((p - m.vertices[t[0]]).dot(normal), 0);
          }
        }
  }
}

TEST(Place, RefusesDataWithoutAVoxelAndBadOptions) {
  EXPECT_THROW(place(icosphere(1), Image(hebron_grid()), {}), InputError);
  EXPECT_THROW(place(icosphere(1), Image(hebron_grid(), 1.0F), {.scale = 0}), OptionError);
}

}  // namespace
}  // namespace dynasurf::mesh
