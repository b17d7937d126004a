#include <random>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/edge_order.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/repair.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/mesh/smooth.hpp"

#include "support/shapes.hpp"

namespace dynasurf::mesh {
namespace {

using namespace test_shapes;

Grid grid_of(const Index3& dims, const Vec3& spacing) {
  Grid g;
  g.dims = dims;
  g.spacing = spacing;
  return g;
}

/// A hollow box of voxels from (5, 6, 7) to (14, 17, 20), whole voxels 20 x 24 x 42 mm.
Image hollow_box() {
  const Grid g = grid_of({20, 24, 28}, {2, 2, 3});
  return border_of(filled(
      g, [](const Vec3& p) { return p[0] > 9 && p[0] < 29 && p[1] > 11 && p[1] < 35 && p[2] > 20 && p[2] < 61; }));
}

Vec3 extent_of(const TriMesh& mesh) {
  Vec3 low = mesh.vertices[0], high = low;
  for (const Vec3& p : mesh.vertices) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return high - low;
}

TEST(CubeSurface, IsACubeRightSideOut) {
  for (const int cells : {1, 2, 7}) {
    const TriMesh cube = cube_surface(cells);
    EXPECT_EQ(cube.vertices.size(), static_cast<std::size_t>(6 * cells * cells + 2));
    EXPECT_TRUE(check_surface(cube).valid());
    EXPECT_NEAR(volume_mm3(cube), 8, 1e-12);
    EXPECT_NEAR(area_mm2(cube), 24, 1e-12);
  }
  EXPECT_THROW(cube_surface(0), OptionError);
}

TEST(EnclosedSolid, FillsWhatTheBorderClosesAlsoBehindAHole) {
  const Image border = hollow_box();
  EXPECT_EQ(count_non_zero(enclosed_solid(border)), 10u * 12u * 14u);
  Image leaking = border;
  leaking(10, 10, 7) = 0;
  EXPECT_EQ(count_non_zero(enclosed_solid(leaking)), 10u * 12u * 14u);
  leaking.values.assign(leaking.values.size(), 0);
  EXPECT_EQ(count_non_zero(enclosed_solid(leaking)), 0u);
}

TEST(EnclosedSolid, LeavesAnOpenCupsOutsideOut) {
  Image cup = hollow_box();
  for (int k = 14; k < 28; ++k)
    for (int j = 0; j < 24; ++j)
      for (int i = 0; i < 20; ++i) cup(i, j, k) = 0;
  EXPECT_EQ(count_non_zero(enclosed_solid(cup)), 10u * 12u * 7u);
}

TEST(StartMesh, FitsEveryShapeAroundTheData) {
  const Image border = hollow_box();
  const Vec3 box(20, 24, 42);
  for (const StartShape shape : {StartShape::ellipsoid, StartShape::cube, StartShape::hull, StartShape::file}) {
    Placement placement;
    placement.shape = shape;
    const TriMesh given = moved(ellipsoid(3, {3, 1, 0.2}), {500, -3, 8});
    const TriMesh mesh = start_mesh(border, 3, placement, &given);
    EXPECT_TRUE(check_surface(mesh).valid());
    EXPECT_LT((extent_of(mesh) - 1.5 * box).norm(), 0.5) << static_cast<int>(shape);
  }
  Placement sphere;
  sphere.shape = StartShape::sphere;
  EXPECT_LT((extent_of(start_mesh(border, 3, sphere)) - Vec3::Constant(63)).norm(), 0.5);
}

TEST(StartMesh, ByTheHullFillsNoHollowButHasNoDent) {
  // An L of voxels: its hull adds half of the missing square, and no more.
  Image border(Grid{.dims = {20, 20, 8}});
  for (int k = 2; k < 6; ++k)
    for (int n = 2; n < 18; ++n)
      for (int m = 2; m < 6; ++m) border(n, m, k) = border(m, n, k) = 1;
  const TriMesh mesh = start_mesh(border, 3, {.shape = StartShape::hull, .scale = 1});
  EXPECT_TRUE(check_surface(mesh).valid());
  EXPECT_EQ(mesh.triangles.size(), 1280u);
  EXPECT_NEAR(volume_mm3(mesh), 4 * (16 * 16 - 12 * 12 / 2.0), 0.02 * 4 * 184);
}

TEST(StartMesh, ByMarchingCubesIsTheSurfaceOfTheSolid) {
  Placement placement;
  placement.shape = StartShape::marching_cubes;
  const TriMesh mesh = start_mesh(hollow_box(), 3, placement);
  EXPECT_TRUE(check_surface(mesh).valid());
  EXPECT_EQ(topology(mesh).components, 1);  // not one inside the wall and one outside
  EXPECT_LT((extent_of(mesh) - Vec3(20, 24, 42)).norm(), 1e-9);
}

TEST(StartMesh, FromInsideLiesInside) {
  Placement placement;
  placement.direction = Direction::in_to_out;
  const TriMesh mesh = start_mesh(hollow_box(), 2, placement);
  EXPECT_LT((extent_of(mesh) - 0.6 * Vec3(20, 24, 42)).norm(), 0.4);
  EXPECT_GT(volume_mm3(mesh), 0);
}

TEST(StartMesh, RefusesAFileThatIsNotGivenOrFlat) {
  Placement placement;
  placement.shape = StartShape::file;
  EXPECT_THROW(start_mesh(hollow_box(), 3, placement), OptionError);
  const TriMesh flat = sheet(3), empty;
  EXPECT_THROW(start_mesh(hollow_box(), 3, placement, &flat), OptionError);
  EXPECT_THROW(start_mesh(hollow_box(), 3, placement, &empty), OptionError);
}

TEST(OrderAround, IsTheOrderOfTheFanSeenFromInside) {
  // The rings of the mesh know the order; shuffled neighbours must come back in it, the other way round.
  const TriMesh mesh = mapped(icosphere(2), [](const Vec3& p) { return Vec3(p[0], 2 * p[1], 3 * p[2]); });
  const VertexRings rings = vertex_rings(mesh);
  std::mt19937 random(4);
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    std::vector<std::uint32_t> ring(rings.of(v).begin(), rings.of(v).end()), shuffled = ring;
    for (std::size_t n = shuffled.size() - 1; n > 0; --n) std::swap(shuffled[n], shuffled[random() % (n + 1)]);
    std::vector<Vec3> positions;
    for (const std::uint32_t n : shuffled) positions.push_back(mesh.vertices[n]);
    const Vec3 p = mesh.vertices[v], normal(p[0], p[1] / 4, p[2] / 9);
    std::vector<std::uint32_t> found;
    for (const std::uint32_t n : order_around(p, normal, positions)) found.push_back(shuffled[n]);
    EXPECT_EQ(found.front(), shuffled.front());
    std::reverse(found.begin(), found.end());
    std::rotate(found.begin(), std::find(found.begin(), found.end(), ring.front()), found.end());
    EXPECT_EQ(found, ring) << v;
  }
}

TEST(OrderAround, NeedsAllFourQuadrantsAndPutsWhatLiesOnTheNormalLast) {
  const std::vector<Vec3> around{{0, 0, 5}, {1, 0, 0}, {-1, 0.5, 0}, {0, -1, 2}, {0, 1, 0}, {-1, -0.5, 0}};
  EXPECT_EQ(order_around({0, 0, 0}, {0, 0, 3}, around), (std::vector<std::uint32_t>{1, 3, 5, 2, 4, 0}));
  EXPECT_TRUE(order_around({0, 0, 0}, {0, 0, 1}, {}).empty());
}

}  // namespace
}  // namespace dynasurf::mesh
