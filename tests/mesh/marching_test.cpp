#include "dynasurf/mesh/marching.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/repair.hpp"

namespace dynasurf::mesh {
namespace {

Image image_of(const Index3& dims, const Vec3& spacing, const auto& value) {
  Grid grid;
  grid.dims = dims;
  grid.spacing = spacing;
  Image image(grid);
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i) image(i, j, k) = static_cast<float>(value(centre_of(grid, {i, j, k})));
  return image;
}

/// 0 on the sphere, falling outwards: a ball of radius 10 mm seen by n voxels along each axis.
Image ball(int n) {
  const double side = 26.0 / (n - 1);
  return image_of({n, n, n}, Vec3::Constant(side), [](const Vec3& p) { return 10 - (p - Vec3(13, 13, 13)).norm(); });
}

Image noise(const Index3& dims, unsigned seed, int values) {
  std::mt19937 random(seed);
  return image_of(dims, {1, 2, 3}, [&](const Vec3&) { return static_cast<double>(random() % unsigned(values)); });
}

double volume_error(int n) {
  return std::abs(volume_mm3(marching_cubes(ball(n), 0)) / (4000 * std::numbers::pi / 3) - 1);
}

TEST(MarchingCubes, OfOneVoxelIsAnOctahedronRightSideOut) {
  Image one(image_of({3, 3, 3}, {2, 4, 6}, [](const Vec3&) { return 0; }));
  one(1, 1, 1) = 1;
  const TriMesh mesh = marching_cubes(one, 0.5);
  EXPECT_EQ(mesh.vertices.size(), 6u);
  EXPECT_EQ(mesh.triangles.size(), 8u);
  EXPECT_NEAR(volume_mm3(mesh), 4.0 / 3 * 1 * 2 * 3, 1e-12);
}

TEST(MarchingCubes, ABallHasOneClosedSurfaceOfEulerNumberTwo) {
  const TriMesh mesh = marching_cubes(ball(21), 0);
  const Topology t = topology(mesh);
  EXPECT_TRUE(t.closed() && t.oriented());
  EXPECT_EQ(t.components, 1);
  EXPECT_EQ(t.euler, 2);
  EXPECT_TRUE(check_surface(mesh).valid());
}

TEST(MarchingCubes, TheVolumeErrorOfABallFallsWithTheSquareOfTheVoxel) {
  // Between lattices of twice the voxels the ratio scatters around 4 with the way the ball lies between the voxels.
  for (const int n : {14, 20, 27}) {
    const double ratio = volume_error(n) / volume_error(2 * n - 1);
    EXPECT_GT(ratio, 3.2) << n;
    EXPECT_LT(ratio, 5) << n;
  }
  EXPECT_LT(volume_error(53), 2e-3);
}

TEST(MarchingCubes, IsClosedManifoldAndOrientedForAnyValues) {
  // Noise has every ambiguous face and every ambiguous cell; few values make ties with the level and at the saddles.
  for (unsigned seed = 0; seed < 30; ++seed) {
    const Image image = noise({7, 6, 5}, seed, seed % 2 == 0 ? 1000 : 5);
    const SurfaceCheck check = check_surface(marching_cubes(image, seed % 2 == 0 ? 500 : 2));
    EXPECT_TRUE(check.closed) << seed;
    EXPECT_TRUE(check.manifold) << seed;
    EXPECT_TRUE(check.oriented) << seed;
    EXPECT_EQ(check.flat_triangles, 0u) << seed;
  }
}

TEST(MarchingCubes, DoesNotMeetItself) {
  for (unsigned seed = 0; seed < 30; ++seed)
    EXPECT_EQ(check_surface(marching_cubes(noise({7, 6, 5}, seed, 1000), 500)).self_intersections, 0u) << seed;
}

TEST(MarchingCubes, JoinsTheCornersOfAFaceAsItsSaddleDoes) {
  // Two corners of 1 on the diagonal of a face; the level at the saddle, the middle of the face, is 0.5 (a + b) / 2.
  const auto components = [](double other) {
    Image image = image_of({2, 2, 1}, {1, 1, 1}, [&](const Vec3& p) { return p[0] == p[1] ? 1.0 : other; });
    return topology(marching_cubes(image, 0.5)).components;
  };
  EXPECT_EQ(components(0.2), 1);   // saddle at 0.6
  EXPECT_EQ(components(-0.2), 2);  // saddle at 0.4
}

TEST(MarchingCubes, AtAnOpenEdgeEndsAtTheOutermostVoxels) {
  const Image full = image_of({4, 4, 4}, {1, 1, 1}, [](const Vec3& p) { return p[2]; });
  const TriMesh open = marching_cubes(full, 1.25, GridEdge::open);
  EXPECT_EQ(topology(open).boundary_edges, 12u);
  for (const Vec3& p : open.vertices) EXPECT_NEAR(p[2], 1.25, 1e-12);
  EXPECT_NEAR(area_mm2(open), 9, 1e-12);
  EXPECT_TRUE(check_surface(marching_cubes(full, 1.25)).valid());
}

TEST(MarchingCubes, OfNothingIsEmptyAndOfEverythingIsABox) {
  const Image image = image_of({3, 4, 5}, {1, 2, 3}, [](const Vec3&) { return 1; });
  EXPECT_TRUE(marching_cubes(image, 2).vertices.empty());
  const TriMesh box = marching_cubes(image, 0.5);
  EXPECT_TRUE(check_surface(box).valid());
  // The box of whole voxels, its edges and corners cut off.
  EXPECT_LT(volume_mm3(box), 360);
  EXPECT_GT(volume_mm3(box), 300);
}

TEST(MarchingCubes, RefusesValuesThatAreNotFinite) {
  Image image = ball(8);
  EXPECT_THROW(marching_cubes(image, std::numeric_limits<double>::quiet_NaN()), InputError);
  image(1, 2, 3) = std::numeric_limits<float>::infinity();
  EXPECT_THROW(marching_cubes(image, 0), InputError);
}

/// Whether a triangle's normal has components of one size and zeros only, on the lattice itself.
bool is_in_a_plain_plane(const TriMesh& mesh, const std::array<std::uint32_t, 3>& t, const Vec3& spacing) {
  const auto at = [&](std::size_t c) { return Vec3(mesh.vertices[t[c]].cwiseQuotient(spacing)); };
  const Vec3 n = (at(1) - at(0)).cross(at(2) - at(0)).cwiseAbs();
  for (int a = 0; a < 3; ++a)
    if (n[a] > 1e-9 && n[a] < n.maxCoeff() - 1e-9) return false;
  return true;
}

double share_in_plain_planes(const TriMesh& mesh, const Vec3& spacing) {
  const auto plain = std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                                   [&](const auto& t) { return is_in_a_plain_plane(mesh, t, spacing); });
  return static_cast<double>(plain) / static_cast<double>(mesh.triangles.size());
}

TEST(DiscretisedMarchingCubes, OfABoxIsABevelledBoxOfTwentySixFacets) {
  Image box(image_of({12, 10, 9}, {1, 2, 3}, [](const Vec3&) { return 0; }));
  for (int k = 1; k < 8; ++k)
    for (int j = 1; j < 9; ++j)
      for (int i = 1; i < 11; ++i) box(i, j, k) = 7;
  const TriMesh merged = discretised_marching_cubes(box, 1),
                whole = discretised_marching_cubes(box, 1, Facets::as_found);
  EXPECT_EQ(merged.vertices.size(), 24u);
  EXPECT_EQ(merged.triangles.size(), 44u);
  EXPECT_GT(whole.triangles.size(), 600u);
  EXPECT_TRUE(check_surface(merged).valid());
  EXPECT_EQ(share_in_plain_planes(merged, box.grid.spacing), 1);
}

TEST(DiscretisedMarchingCubes, HasTheTopologyOfMarchingCubesForAnyValues) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const Image image = noise({7, 6, 5}, seed, seed % 2 == 0 ? 1000 : 5);
    const double level = seed % 2 == 0 ? 500 : 2;
    const TriMesh merged = discretised_marching_cubes(image, level),
                  whole = discretised_marching_cubes(image, level, Facets::as_found);
    const Topology reference = topology(marching_cubes(image, level));
    for (const TriMesh* mesh : {&merged, &whole}) {
      const SurfaceCheck check = check_surface(*mesh);
      EXPECT_TRUE(check.closed && check.manifold && check.oriented) << seed;
      EXPECT_EQ(check.flat_triangles, 0u) << seed;
      EXPECT_EQ(check.self_intersections, 0u) << seed;
      EXPECT_EQ(topology(*mesh).components, reference.components) << seed;
      EXPECT_EQ(topology(*mesh).euler, reference.euler) << seed;
      EXPECT_GT(share_in_plain_planes(*mesh, image.grid.spacing), 0.9) << seed;
    }
    EXPECT_LT(merged.triangles.size(), whole.triangles.size()) << seed;
  }
}

TEST(DiscretisedMarchingCubes, MergesFacetsWithoutMovingTheSurface) {
  for (const Image& image : {ball(21), noise({9, 8, 7}, 3, 1000)}) {
    const double level = image.grid.dims[0] == 21 ? 0 : 500;
    const TriMesh merged = discretised_marching_cubes(image, level),
                  whole = discretised_marching_cubes(image, level, Facets::as_found);
    EXPECT_NEAR(volume_mm3(merged) / volume_mm3(whole), 1, 1e-12);
    EXPECT_NEAR(area_mm2(merged) / area_mm2(whole), 1, 1e-12);
  }
  const TriMesh merged = discretised_marching_cubes(ball(41), 0), cubes = marching_cubes(ball(41), 0);
  EXPECT_LT(static_cast<double>(merged.triangles.size()), 0.7 * static_cast<double>(cubes.triangles.size()));
  EXPECT_NEAR(volume_mm3(merged) / volume_mm3(cubes), 1, 0.01);
  EXPECT_EQ(share_in_plain_planes(merged, Vec3::Constant(26.0 / 40)), 1);
}

TEST(DiscretisedMarchingCubes, OfNothingIsEmptyAndRefusesWhatIsNotFinite) {
  EXPECT_TRUE(discretised_marching_cubes(ball(8), 100).triangles.empty());
  EXPECT_THROW(discretised_marching_cubes(ball(8), std::numeric_limits<double>::quiet_NaN()), InputError);
}

double area_of(const IsoLine& line) {
  double area = 0;
  for (std::size_t n = 0; n + 1 < line.size(); ++n)
    area += (line[n][0] * line[n + 1][1] - line[n][1] * line[n + 1][0]) / 2;
  return area;
}

TEST(MarchingSquares, FindsTheCircleOfASphereCounterClockwise) {
  const Image image = ball(27);
  const auto lines = marching_squares(image, 13, 0);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].front(), lines[0].back());
  // Chords of a pixel in a circle of ten lose h^2 / 6 R^2 = 0.0017, the linear reading of the distance a little more.
  EXPECT_NEAR(area_of(lines[0]) / (100 * std::numbers::pi), 1, 3e-3);
}

TEST(MarchingSquares, ReadsASaddleInBothWays) {
  const Image image = image_of({4, 4, 1}, {1, 1, 1},
                               [](const Vec3& p) { return (p == Vec3(1, 1, 0)) || (p == Vec3(2, 2, 0)) ? 1.0 : 0.0; });
  const auto joined = marching_squares(image, 0, 0.5, Saddle::joined);
  const auto separated = marching_squares(image, 0, 0.5, Saddle::separated);
  ASSERT_EQ(joined.size(), 1u);
  ASSERT_EQ(separated.size(), 2u);
  EXPECT_NEAR(area_of(separated[0]) + area_of(separated[1]), 1, 1e-12);  // two squares with half diagonals
  EXPECT_NEAR(area_of(joined[0]), 1.5, 1e-12);                           // and the bridge between them
  EXPECT_EQ(marching_squares(image, 0, 0.4, Saddle::asymptotic).size(), 1u);
  EXPECT_EQ(marching_squares(image, 0, 0.6, Saddle::asymptotic).size(), 2u);
}

TEST(MarchingSquares, EndsLinesAtTheBorderOfTheSlice) {
  const Image image = image_of({5, 4, 1}, {1, 1, 1}, [](const Vec3& p) { return p[0]; });
  const auto lines = marching_squares(image, 0, 1.5);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].size(), 4u);
  EXPECT_EQ(lines[0].front(), Eigen::Vector2d(1.5, 3));  // downwards: what is above lies to the left
  EXPECT_EQ(lines[0].back(), Eigen::Vector2d(1.5, 0));
}

TEST(MarchingSquares, RefusesASliceThatIsNotThere) {
  EXPECT_THROW(marching_squares(ball(8), 8, 0), InputError);
  EXPECT_THROW(marching_squares(ball(8), -1, 0), InputError);
}

}  // namespace
}  // namespace dynasurf::mesh
