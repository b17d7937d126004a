#include "dynasurf/cloud/detail/indicator_field.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/cloud/detail/body.hpp"
#include "dynasurf/cloud/detail/levels.hpp"
#include "dynasurf/cloud/detail/prepare.hpp"
#include "dynasurf/cloud/detail/thesis_recipe.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/repair.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"
#include "dynasurf/synthetic/detail/random.hpp"

namespace dynasurf::cloud {
namespace {

PointCloud scan(synthetic::CloudShape shape, double noise_percent = 0, double missing_percent = 0, int points = 6000) {
  return synthetic::make_cloud({.shape = shape,
                                .points = points,
                                .noise_percent = noise_percent,
                                .missing_percent = missing_percent,
                                .normals = true});
}

PointCloud without_normals(PointCloud cloud) {
  cloud.normals.clear();
  return cloud;
}

TEST(Prepare, EstimatesTheNoiseOfASphere) {
  // Fits of 100 points to a sphere whose neighbourhoods are ten times as wide as the noise; the median of 1500.
  const PreparedCloud p = prepare(without_normals(scan(synthetic::CloudShape::sphere, 0.5)), {});
  EXPECT_NEAR(100 * p.facts.noise / p.facts.diagonal, 0.5, 0.1);
  const PreparedCloud clean = prepare(without_normals(scan(synthetic::CloudShape::sphere)), {});
  EXPECT_LT(100 * clean.facts.noise / clean.facts.diagonal, 0.01);
}

// Its wall is 2.4 % of the diagonal thick: a hundred neighbours reach its other side and made the noise 0.88 %.
TEST(Prepare, DoesNotTakeAThinWallForNoise) {
  const PreparedCloud p = prepare(
      synthetic::make_cloud({.shape = synthetic::CloudShape::vase, .points = 50000, .noise_percent = 0.5}), {}, {});
  EXPECT_NEAR(100 * p.facts.noise / p.facts.diagonal, 0.5, 0.06);
}

/// Both sides of half a spherical shell of radius 1, or one side of it, with normal noise.
PointCloud half_shell(double wall, double noise) {
  synthetic::Random random(5);
  PointCloud cloud;
  while (cloud.points.size() < 20000) {
    const Vec3 way = Vec3(random.normal(), random.normal(), -std::abs(random.normal())).normalized();
    const double side = random.uniform() < 0.5 ? 0 : wall;
    cloud.points.push_back((1 - side + noise * random.normal()) * way);
  }
  return cloud;
}

bool tells_layers(const Notes& notes) {
  return std::any_of(notes.begin(), notes.end(), [](const Note& n) { return n.code == "cloud.layers"; });
}

// The wall is as thin as the points of a side lie apart.
TEST(Prepare, TakesBothSidesOfAThinWallForNoNoise) {
  constexpr double wall = 0.035;
  const PreparedCloud p = prepare(half_shell(wall, 0), {});
  EXPECT_NEAR(p.facts.spacing, wall / std::sqrt(2.0), 0.3 * wall);
  EXPECT_LT(p.facts.noise, 0.05 * wall);
  EXPECT_FALSE(tells_layers(p.notes));
  const PreparedCloud noisy = prepare(half_shell(wall, 0.1 * wall), {});
  EXPECT_NEAR(noisy.facts.noise, 0.1 * wall, 0.04 * wall);
}

TEST(Prepare, TellsLayersThatNoiseHides) {
  constexpr double wall = 0.04;
  EXPECT_TRUE(tells_layers(prepare(half_shell(wall, 0.35 * wall), {}).notes));
  EXPECT_FALSE(tells_layers(prepare(half_shell(0, 0.6 * wall), {}).notes)) << "noise as large around one surface";
  EXPECT_FALSE(tells_layers(prepare(half_shell(0, 0), {}).notes));
}

TEST(Prepare, TellsTheSpacingOfASphere) {
  const PreparedCloud p = prepare(scan(synthetic::CloudShape::sphere), {});
  // 6,000 points share an area of 4 pi.
  EXPECT_NEAR(p.facts.spacing, std::sqrt(4 * 3.14159 / 6000), 0.1 * p.facts.spacing);
}

TEST(Prepare, ForgetsOnePointAtTheEndOfTheWorld) {
  PointCloud cloud = scan(synthetic::CloudShape::sphere);
  cloud.normals.clear();
  cloud.points.push_back({1e12, 0, 0});
  const PreparedCloud p = prepare(cloud, {});
  EXPECT_EQ(p.facts.outliers, 1u);
  EXPECT_NEAR(p.facts.diagonal, 2 * std::sqrt(3.0), 0.01);
}

class OrientOf : public testing::TestWithParam<synthetic::CloudShape> {};

TEST_P(OrientOf, FindsTheNormalsThatWereNotGiven) {
  // The wall of the vase is about three spacings of 20,000 points thick.
  const PointCloud cloud = scan(GetParam(), 0, 0, 20000);
  const OrientedPoints o = orient(without_normals(cloud), true);
  std::size_t outwards = 0;
  for (std::size_t i = 0; i < o.points.size(); ++i) outwards += o.normals[i].dot(cloud.normals[i]) > 0;
  // At the sharp edges of cube and plate the plane of a point may belong to either side.
  EXPECT_GT(static_cast<double>(outwards), 0.99 * static_cast<double>(o.points.size()));
}

INSTANTIATE_TEST_SUITE_P(Shapes, OrientOf,
                         testing::Values(synthetic::CloudShape::sphere, synthetic::CloudShape::two_torus,
                                         synthetic::CloudShape::cube, synthetic::CloudShape::plate,
                                         synthetic::CloudShape::spring, synthetic::CloudShape::vase),
                         [](const auto& one) { return std::string(word_of(one.param)); });

TEST(Orient, TakesNormalsThatAreGiven) {
  PointCloud given = scan(synthetic::CloudShape::sphere);
  for (Vec3& n : given.normals) n = 2 * (n + 0.5 * n.cross(Vec3::UnitZ()));
  const OrientedPoints o = orient(given, true);
  for (std::size_t i = 0; i < o.points.size(); ++i)
    EXPECT_LT((o.normals[i] - given.normals[i].normalized()).norm(), 1e-12);
  for (Vec3& n : given.normals) n = -n;
  const OrientedPoints turned = orient(given, true);  // they pointed into what they enclose
  for (std::size_t i = 0; i < o.points.size(); ++i) EXPECT_EQ(turned.normals[i], o.normals[i]);
}

/// The lower half of the vase: a pot whose two sides hang together nowhere.
PointCloud pot(int points) {
  PointCloud cloud = synthetic::make_cloud({.shape = synthetic::CloudShape::vase, .points = points, .normals = true});
  std::size_t n = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (cloud.points[i][2] < 0.1) {
      cloud.points[n] = cloud.points[i];
      cloud.normals[n++] = cloud.normals[i];
    }
  cloud.points.resize(n);
  cloud.normals.resize(n);
  return cloud;
}

TEST(Orient, TurnsTheInnerSideOfAWallInwardsWhereItsRimIsMissing) {
  const PointCloud cloud = pot(40000);
  const OrientedPoints o = orient(cloud, false);
  ASSERT_EQ(o.sheets, 2u);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < o.points.size(); ++i) wrong += o.normals[i].dot(cloud.normals[i]) < 0;
  EXPECT_EQ(wrong, 0u);
}

TEST(Orient, TurnsBodiesThatStandApartOutwardsEach) {
  PointCloud cloud = scan(synthetic::CloudShape::sphere);
  const std::size_t one = cloud.points.size();
  for (std::size_t i = 0; i < one; ++i) cloud.points.push_back(cloud.points[i] + Vec3(2.2, 0, 0));
  const OrientedPoints o = orient(without_normals(cloud), true);
  EXPECT_EQ(o.sheets, 2u);
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    EXPECT_GT(o.normals[i].dot(i < one ? cloud.points[i] : Vec3(cloud.points[i] - Vec3(2.2, 0, 0))), 0);
}

TEST(ThinOut, LeavesOnePointPerCellInTheMiddleOfItsOwn) {
  const PointCloud cloud{{Vec3(0, 0, 0), Vec3(0.2, 0, 0), Vec3(5, 5, 5)}, {}, {}, {}};
  const PointCloud thin = voxel_downsample(cloud, 1);
  ASSERT_EQ(thin.points.size(), 2u);
  EXPECT_EQ(thin.points[0], Vec3(0.1, 0, 0));
  EXPECT_EQ(voxel_downsample(cloud, 0).points.size(), 3u);
}

TEST(FindInside, IsAHalfInsideAndMinusAHalfOutsideASphere) {
  const IndicatorField field = solve_indicator(orient(scan(synthetic::CloudShape::sphere), true), {.cells = 32}).back();
  const Grid& g = field.value.grid;
  for (int i = 0; i < g.dims[0]; ++i) {
    const Vec3 at = field.origin + field.side * Vec3(i, (g.dims[1] - 1) / 2.0, (g.dims[2] - 1) / 2.0);
    const float value = field.value(i, (g.dims[1] - 1) / 2, (g.dims[2] - 1) / 2);
    // Two steps from the surface the slope has done its work; the equation is solved to a few percent.
    if (std::abs(at.norm() - 1) < 2 * field.side) continue;
    EXPECT_NEAR(value, at.norm() < 1 ? 0.5 : -0.5, 0.1) << at.norm();
  }
  EXPECT_GT(outwards(field, Vec3(0, 0, 1)).z(), 0.99);
}

TEST(FindInside, PutsTheSurfaceOnThePoints) {
  const PointCloud cloud = scan(synthetic::CloudShape::ellipsoid);
  const TriMesh mesh = body_surface(solve_indicator(orient(cloud, true), {.cells = 48}).back(), 0, cloud.points, 0.02);
  EXPECT_EQ(mesh::topology(mesh).euler, 2);
  // Half axes 1, 0.6, 0.35: within a twentieth of a step of 2/48 on average, so of the volume to half a percent.
  EXPECT_NEAR(mesh::volume_mm3(mesh), 4.0 / 3 * 3.14159 * 0.6 * 0.35, 0.005);
}

TEST(BodySurface, DropsPartsThatFewPointsSpeakFor) {
  PointCloud cloud = scan(synthetic::CloudShape::sphere);
  const PointCloud small = synthetic::make_cloud({.points = 150, .normals = true});
  for (std::size_t i = 0; i < small.points.size(); ++i) {
    cloud.points.push_back(Vec3(2, 0, 0) + 0.3 * small.points[i]);
    cloud.normals.push_back(small.normals[i]);
  }
  const IndicatorField field = solve_indicator(orient(cloud, true), {.cells = 48}).back();
  EXPECT_EQ(mesh::topology(body_surface(field, 0, cloud.points, 0)).components, 2);
  EXPECT_EQ(mesh::topology(body_surface(field, 0, cloud.points, 0.05)).components, 1);
}

TEST(ChooseBody, GivesHandlesByRule) {
  const PointCloud cloud = scan(synthetic::CloudShape::two_torus);
  const auto fields = solve_indicator(orient(cloud, true), {.cells = 48});
  const auto genus_by = [&](GenusRule rule) {
    Options options;
    options.genus = rule;
    Notes notes;
    const Body body = choose_body(fields, cloud.points, options, notes);
    EXPECT_TRUE(notes.empty());
    EXPECT_TRUE(mesh::check_surface(body.mesh).valid());
    EXPECT_EQ(mesh::topology(body.mesh).euler, 2 - 2 * body.genus);
    return body.genus;
  };
  EXPECT_EQ(genus_by(GenusRule::automatic), 2);
  EXPECT_EQ(genus_by(GenusRule::keep), 2);
  EXPECT_EQ(genus_by(GenusRule::zero), 0);
}

TEST(WithoutHandles, CutsATorusOnceAndTakesLittle) {
  const auto fields = solve_indicator(orient(scan(synthetic::CloudShape::torus), true), {.cells = 48});
  const IndicatorField cut = without_handles(fields.back());
  std::size_t before = 0, after = 0;
  for (std::size_t i = 0; i < cut.value.values.size(); ++i) {
    before += fields.back().value.values[i] > 0;
    after += cut.value.values[i] > 0;
  }
  EXPECT_LT(after, before);
  // One disc across a tube of about 12 nodes in diameter, of a ring 113 nodes long; where the two fronts meet askew, it
  // is a few nodes thick.
  EXPECT_GT(static_cast<double>(after), 0.94 * static_cast<double>(before));
}

TEST(Fit, BringsACoarseSphereNearerToItsPoints) {
  const PointCloud cloud = scan(synthetic::CloudShape::sphere);
  mesh::SurfaceEditor s(mesh::icosphere(2));
  const double before = mean_distance(s, cloud.points);
  fit(s, {cloud.points, cloud.normals}, {.rounds = 4});
  // Faces that cut the sphere are on average a quarter to a half as far from it as faces below it.
  EXPECT_LT(mean_distance(s, cloud.points), 0.5 * before);
  EXPECT_TRUE(mesh::check_surface(s.mesh()).valid());
}

TEST(Fit, IsNotDrawnToPointsThatLookTheOtherWay) {
  PointCloud cloud = scan(synthetic::CloudShape::sphere);
  for (Vec3& p : cloud.points) p *= 0.8;
  for (Vec3& n : cloud.normals) n *= -1;
  mesh::SurfaceEditor s(mesh::icosphere(2));
  const double volume = mesh::volume_mm3(s.mesh());
  fit(s, {cloud.points, cloud.normals}, {.rounds = 2, .smoothness = 0});
  EXPECT_NEAR(mesh::volume_mm3(s.mesh()), volume, 1e-6);
  fit(s, {cloud.points, {}}, {.rounds = 4});
  EXPECT_LT(mesh::volume_mm3(s.mesh()), 0.6 * volume);
}

TEST(Voxelise, PutsTheCloudInTheMiddleOfItsGrid) {
  const CloudVoxels v = voxelise(std::vector<Vec3>{Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(0, 0.5, 0)});
  EXPECT_EQ(v.border.grid.dims, (Index3{62, 62, 62}));
  EXPECT_DOUBLE_EQ(v.side, 2.0 / 54);
  EXPECT_EQ(v.border(4, 24, 30) + v.border(4, 24, 31), 1);
  EXPECT_EQ(v.border(57, 24, 30) + v.border(57, 24, 31), 1);
}

}  // namespace
}  // namespace dynasurf::cloud
