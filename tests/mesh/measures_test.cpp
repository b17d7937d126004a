#include "dynasurf/mesh/measures.hpp"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/shapes.hpp"

namespace dynasurf::mesh {
namespace {

using namespace test_shapes;

TEST(VolumeMm3, IsExactOnAnalyticMeshes) {
  EXPECT_NEAR(volume_mm3(cube()), 1, 1e-10);
  EXPECT_NEAR(volume_mm3(tetrahedron()), 1.0 / 6, 1e-10);
  // Regular icosahedron of circumradius 1: edge a = 1/sin(2 pi/5), volume 5 (3 + sqrt 5) a^3 / 12.
  const double a = 1 / std::sin(2 * std::numbers::pi / 5);
  EXPECT_NEAR(volume_mm3(icosphere(0)), 5 * (3 + std::sqrt(5.0)) * a * a * a / 12, 1e-10);
  // A torus of regular polygons, swept straight between its stations, is a sum of prismatoids: area of the polygon
  // times the length of the polygon its centroid runs on, in the limit; here only the sign and the size.
  EXPECT_NEAR(volume_mm3(torus(30, 10, 400, 200)), 2 * std::pow(std::numbers::pi * 10, 2) * 30, 60);
}

TEST(VolumeMm3, AgreesWithTheQuadratureOfTheThesis) {
  for (const auto& [name, m] : closed_meshes()) EXPECT_NEAR(volume_mm3_quadrature(m) / volume_mm3(m), 1, 1e-12) << name;
}

TEST(VolumeMm3, IgnoresTheOrigin) {
  for (const auto& [name, m] : closed_meshes())
    EXPECT_NEAR(volume_mm3(moved(m, {300, -200, 450})) / volume_mm3(m), 1, 1e-11) << name;
}

TEST(VolumeMm3, GrowsWithTheCubeOfTheScaleAndTurnsItsSignWithTheTriangles) {
  for (const auto& [name, m] : closed_meshes()) {
    const double v = volume_mm3(m);
    EXPECT_GT(v, 0) << name;
    EXPECT_NEAR(volume_mm3(mapped(m, [](const Vec3& p) { return Vec3(3 * p); })) / v, 27, 1e-9) << name;
    TriMesh inside_out = m;
    for (auto& t : inside_out.triangles) std::swap(t[0], t[1]);
    EXPECT_NEAR(volume_mm3(inside_out) / v, -1, 1e-12) << name;
  }
}

TEST(AreaMm2, IsKnownForTheCubeAndNearTheSphere) {
  EXPECT_NEAR(area_mm2(cube()), 6, 1e-12);
  EXPECT_NEAR(area_mm2(icosphere(5)), 4 * std::numbers::pi, 0.01);
  EXPECT_LT(area_mm2(icosphere(5)), 4 * std::numbers::pi);
}

TEST(TriangleQuality, IsKnownForAnEquilateralTriangle) {
  const TriMesh m{{{0, 0, 0}, {4, 0, 0}, {2, 2 * std::numbers::sqrt3, 0}}, {{0, 1, 2}}};
  const TriangleQuality q = triangle_quality(m);
  EXPECT_NEAR(q.area_mean, 4 * std::numbers::sqrt3, 1e-12);
  EXPECT_NEAR(q.d_mean, 4 * 0.4330127018922193, 1e-12);
  EXPECT_NEAR(q.shape_min, 1, 1e-12);
  EXPECT_NEAR(q.smallest_angle_deg, 60, 1e-12);
}

TEST(TriangleQuality, ReportsTheExtremesOfALongAndAFlatTriangle) {
  const TriMesh m{{{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {6, 0, 0}}, {{0, 1, 2}, {0, 1, 3}}};
  const TriangleQuality q = triangle_quality(m);
  EXPECT_EQ(q.area_min, 0);
  EXPECT_NEAR(q.area_max, 6, 1e-12);
  EXPECT_NEAR(q.d_max, 1.2, 1e-12);
  EXPECT_EQ(q.d_min, 0);
  EXPECT_EQ(q.shape_min, 0);
  EXPECT_EQ(q.smallest_angle_deg, 0);
}

TEST(TriangleQuality, IsZeroNotNanWhereThereIsNothingToMeasure) {
  EXPECT_EQ(triangle_quality({}).area_min, 0);
  const TriangleQuality q = triangle_quality({{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}}});
  EXPECT_EQ(q.d_mean, 0);
  EXPECT_EQ(q.shape_mean, 0);
}

TEST(TriangleQuality, MatchesTheThesisOnItsStretchedSphere) {
  // Spec N4: the icosphere scaled to 53.5 x 56.6 x 70 mm, recomputed there to the digits given.
  const double expected[3][6] = {{138.6, 7.03, 180.9, 7.93, 111.1, 6.12},
                                 {35.15, 3.54, 46.45, 4.02, 27.91, 3.04},
                                 {8.82, 1.77, 11.69, 2.02, 6.99, 1.51}};
  for (int level = 2; level <= 4; ++level) {
    const TriangleQuality q = triangle_quality(ellipsoid(level, {53.5, 56.6, 70}));
    const double* e = expected[level - 2];
    EXPECT_NEAR(q.area_mean / e[0], 1, 2e-3);
    EXPECT_NEAR(q.d_mean / e[1], 1, 4e-3);
    // The extremes depend on how the icosahedron is turned against the axes, which the thesis does not tell.
    EXPECT_NEAR(q.area_max / e[2], 1, 0.02);
    EXPECT_NEAR(q.d_max / e[3], 1, 0.02);
    EXPECT_NEAR(q.area_min / e[4], 1, 0.02);
    EXPECT_NEAR(q.d_min / e[5], 1, 0.02);
  }
}

TEST(Topology, KnowsSpheresToriAndSheets) {
  for (const auto& [name, m] : closed_meshes()) {
    const Topology t = topology(m);
    EXPECT_EQ(t.euler, name == "torus" ? 0 : 2) << name;
    EXPECT_EQ(t.components, 1) << name;
    EXPECT_TRUE(t.closed()) << name;
    EXPECT_TRUE(t.oriented()) << name;
    EXPECT_EQ(2 * t.edges, 3 * t.triangles) << name;
  }
  const Topology t = topology(sheet(4));
  EXPECT_EQ(t.boundary_edges, 16U);
  EXPECT_EQ(t.euler, 1);
  EXPECT_FALSE(t.closed());
  EXPECT_TRUE(t.oriented());
}

TEST(Topology, FindsPiecesTurnedTrianglesAndPages) {
  TriMesh two = cube();
  const TriMesh other = moved(cube(), {5, 0, 0});
  two.vertices.insert(two.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (auto t : other.triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  EXPECT_EQ(topology(two).components, 2);
  EXPECT_EQ(topology(two).euler, 4);

  TriMesh turned = cube();
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  EXPECT_EQ(topology(turned).misoriented_edges, 3U);

  const TriMesh book{{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}};
  EXPECT_EQ(topology(book).non_manifold_edges, 1U);
  EXPECT_FALSE(topology(book).closed());
  EXPECT_EQ(topology({}).components, 0);
}

Grid uneven_grid() {
  Grid g;
  g.dims = {9, 12, 7};
  g.spacing = {2, 3, 5};
  return g;
}

double nearest_by_looking_at_all(const Vec3& p, const Image& border, const Vec3& unit) {
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k < border.grid.dims[2]; ++k)
    for (int j = 0; j < border.grid.dims[1]; ++j)
      for (int i = 0; i < border.grid.dims[0]; ++i)
        if (border(i, j, k) != 0)
          best = std::min(best, (p - centre_of(border.grid, {i, j, k})).cwiseQuotient(unit).norm());
  return best;
}

TEST(DistancesToBorder, AreMeasuredFromCentresInVoxelsOrMm) {
  Image border(uneven_grid());
  border(4, 4, 4) = 1;
  const TriMesh m{{{8, 12, 20}, {8, 12, 25}, {10, 15, 20}}, {}};
  EXPECT_THAT(distances_to_border_voxels(m, border), testing::ElementsAre(0, 1, std::sqrt(2.0)));
  EXPECT_THAT(distances_to_border_mm(m, border), testing::ElementsAre(0, 5, std::sqrt(13.0)));
}

TEST(DistancesToBorder, EqualASearchOfAllVoxelsInsideAndOutsideTheGrid) {
  std::mt19937 random(7);
  const auto between = [&](double a, double b) { return a + (b - a) * (random() / 4294967296.0); };
  for (const double density : {0.003, 0.05, 0.5}) {
    Image border(uneven_grid());
    for (float& v : border.values) v = between(0, 1) < density ? 1.0F : 0.0F;
    border(8, 11, 6) = 1;
    TriMesh m;
    for (int v = 0; v < 300; ++v) m.vertices.emplace_back(between(-20, 36), between(-20, 53), between(-20, 50));
    const auto voxels = distances_to_border_voxels(m, border), mm = distances_to_border_mm(m, border);
    for (std::size_t v = 0; v < m.vertices.size(); ++v) {
      EXPECT_NEAR(voxels[v], nearest_by_looking_at_all(m.vertices[v], border, border.grid.spacing), 1e-12);
      EXPECT_NEAR(mm[v], nearest_by_looking_at_all(m.vertices[v], border, Vec3::Ones()), 1e-12);
    }
  }
}

TEST(SignedDistancesToBorder, ArePositiveOutsideWhatTheBorderEncloses) {
  Grid g;
  g.dims = {21, 21, 21};
  g.spacing = {1, 1, 2};
  Image border(g);  // the surface of a box from voxel 5 to 15
  for (int k = 5; k <= 15; ++k)
    for (int j = 5; j <= 15; ++j)
      for (int i = 5; i <= 15; ++i)
        border(i, j, k) = i == 5 || i == 15 || j == 5 || j == 15 || k == 5 || k == 15 ? 1.0F : 0.0F;
  const TriMesh points{{{2, 10, 20}, {8, 10, 20}, {10, 10, 34}, {-50, 10, 20}, {14.9, 10, 20}}, {}};
  const std::vector<double> d = signed_distances_to_border_voxels(points, border);
  EXPECT_EQ(d[0], 3);
  EXPECT_EQ(d[1], -3);
  EXPECT_EQ(d[2], 2);  // two slices above
  EXPECT_EQ(d[3], 55);
  EXPECT_NEAR(d[4], -0.1, 1e-12);  // border voxels belong to the solid
}

TEST(ShareOfBorderReached, CountsTheBorderThatHasASurfaceNearIt) {
  // A plane of 20 x 20 voxels of 2 x 2 x 4 mm, and a square of two triangles over a half, a quarter, or none of it.
  Grid g;
  g.dims = {20, 20, 5};
  g.spacing = {2, 2, 4};
  Image border(g);
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 20; ++i) border(i, j, 2) = 1;
  const auto square_over = [](double x_mm, double y_mm, double z_mm) {
    return TriMesh{{{0, 0, z_mm}, {x_mm, 0, z_mm}, {x_mm, y_mm, z_mm}, {0, y_mm, z_mm}}, {{0, 1, 2}, {0, 2, 3}}};
  };
  EXPECT_EQ(share_of_border_reached(square_over(38, 38, 8), border), 1);
  EXPECT_EQ(share_of_border_reached(square_over(38, 38, 11.6), border), 1);
  EXPECT_EQ(share_of_border_reached(square_over(38, 38, 11.98), border), 1);
  EXPECT_EQ(share_of_border_reached(square_over(38, 38, 12.1), border), 0);
  EXPECT_EQ(share_of_border_reached(square_over(18, 38, 8), border), 0.5);  // 0.0 to 9.0 voxels: ten of twenty
  EXPECT_EQ(share_of_border_reached(square_over(18, 18, 8), border), 0.25);
  EXPECT_EQ(share_of_border_reached(square_over(18, 18, 8), border, 2), 121.0 / 400);
  EXPECT_EQ(share_of_border_reached({}, border), 0);
  EXPECT_EQ(share_of_border_reached({}, Image(g)), 1);
  EXPECT_EQ(share_of_border_reached(square_over(1e6, 1e6, 1e6), border), 0);  // far outside the grid
}

TEST(DistancesToBorder, AreInfiniteWithoutABorder) {
  const TriMesh m{{{8, 12, 20}}, {}};
  EXPECT_EQ(distances_to_border_voxels(m, Image(uneven_grid()))[0], std::numeric_limits<double>::infinity());
  EXPECT_EQ(distances_to_border_mm(m, Image(uneven_grid()))[0], std::numeric_limits<double>::infinity());
}

double area_about(const std::vector<Vec3>& polygon, const Vec3& normal) {
  Vec3 twice = Vec3::Zero();
  for (std::size_t v = 0; v + 1 < polygon.size(); ++v) twice += polygon[v].cross(polygon[v + 1]);
  return twice.dot(normal) / 2;
}

TEST(CrossSection, CutsACubeInASquare) {
  const auto polygons = cross_section(cube(), {0, 0, 0.25}, {0, 0, 1});
  ASSERT_EQ(polygons.size(), 1U);
  EXPECT_EQ(polygons[0].front(), polygons[0].back());
  EXPECT_NEAR(area_about(polygons[0], {0, 0, 1}), 1, 1e-12);  // positive: counter-clockwise
}

TEST(CrossSection, CutsATorusInTwoRings) {
  const auto polygons = cross_section(torus(30, 10, 64, 32), {0, 0, 1}, {0, 0, 1});
  ASSERT_EQ(polygons.size(), 2U);
  double area = 0;
  for (const auto& polygon : polygons) area += area_about(polygon, {0, 0, 1});
  const double half_width = std::sqrt(99.0);
  EXPECT_NEAR(area, std::numbers::pi * (std::pow(30 + half_width, 2) - std::pow(30 - half_width, 2)), 40);
}

TEST(CrossSection, IsClosedAndInThePlaneForEveryShapeAndPlaneEvenThroughVertices) {
  for (const auto& [name, m] : closed_meshes())
    for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(1, 2, -1).normalized()})
      for (std::size_t v = 0; v < m.vertices.size(); v += 1 + m.vertices.size() / 40)
        for (const auto& polygon : cross_section(m, m.vertices[v], normal)) {
          EXPECT_GE(polygon.size(), 4U) << name;
          EXPECT_EQ(polygon.front(), polygon.back()) << name;
          for (const Vec3& p : polygon) EXPECT_NEAR((p - m.vertices[v]).dot(normal), 0, 1e-9) << name;
          for (std::size_t i = 1; i < polygon.size(); ++i) EXPECT_NE(polygon[i], polygon[i - 1]) << name;
        }
}

TEST(CrossSection, SlicesAddUpToTheVolume) {
  // Cavalieri: the midpoint rule over 400 slices is good to 1e-4 for smooth shapes; a flat side needs no more.
  for (const auto& [name, m] : closed_meshes()) {
    double low = 1e9, high = -1e9;
    for (const Vec3& p : m.vertices) low = std::min(low, p[2]), high = std::max(high, p[2]);
    double volume = 0;
    for (int s = 0; s < 400; ++s) {
      const double z = low + (s + 0.5) * (high - low) / 400;
      for (const auto& polygon : cross_section(m, {0, 0, z}, {0, 0, 1}))
        volume += area_about(polygon, {0, 0, 1}) * (high - low) / 400;
    }
    EXPECT_NEAR(volume / volume_mm3(m), 1, 1e-4) << name;
  }
}

TEST(CrossSection, OfAnOpenMeshIsAnOpenLineAndOfAMissIsNothing) {
  const auto lines = cross_section(sheet(4), {1.5, 0, 0}, {1, 0, 0});
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NEAR((lines[0].front() - lines[0].back()).norm(), 4, 1e-12);
  EXPECT_TRUE(cross_section(cube(), {0, 0, 7}, {0, 0, 1}).empty());
  EXPECT_TRUE(cross_section(icosphere(2), {0, 0, 1.0000001}, {0, 0, 1}).empty());
}

}  // namespace
}  // namespace dynasurf::mesh
