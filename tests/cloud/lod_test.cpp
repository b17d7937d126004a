#include "dynasurf/cloud/lod.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/repair.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"

namespace dynasurf::cloud {
namespace {

/// Icospheres stretched to an egg with a bump, finest first: 1280, 320, 80 triangles.
std::vector<TriMesh> eggs() {
  std::vector<TriMesh> levels;
  for (const int level : {3, 2, 1}) {
    TriMesh mesh = mesh::icosphere(level);
    for (Vec3& p : mesh.vertices) p = Vec3(p[0], 1.5 * p[1], 0.8 * p[2]) * (1 + 0.3 * std::exp(3 * (p[0] - 1)));
    levels.push_back(std::move(mesh));
  }
  return levels;
}

TEST(LodCamera, ProjectsAHeightThatFillsThePicture) {
  const Camera camera{1920, 1080, 40};
  // What spans the field of view at distance 5 is as high as the picture.
  const double height = 2 * 5 * std::tan(20 * std::numbers::pi / 180);
  EXPECT_NEAR(focal_px(camera) * height / 5, 1080, 1e-9);
  EXPECT_NEAR(projected_size_px({-0.01, -height / 2, -5}, {0.01, height / 2, -5}, {}, camera), 1080, 1e-9);
}

TEST(LodCamera, SeesABoxSmallerWithDistanceAndLargerWithANarrowField) {
  const Vec3 low(-1, -1, -1), high(1, 1, 1);
  const auto size = [&](double away, double fov) {
    return projected_size_px(low, high, {{0, 0, away}, {0, 0, -1}, {0, 1, 0}}, {800, 600, fov});
  };
  EXPECT_GT(size(5, 40), size(10, 40));
  EXPECT_GT(size(10, 20), size(10, 40));
  EXPECT_NEAR(size(2001, 40) / size(4001, 40), 2, 1e-2) << "far away the size falls with the distance";
  EXPECT_TRUE(std::isinf(size(0.5, 40))) << "the eye is in the box";
}

TEST(LodCamera, SeesTheSameBoxFromEverySide) {
  const Camera camera;
  const double front = projected_size_px({-1, -1, -1}, {1, 1, 1}, {{0, 0, 9}, {0, 0, -1}, {0, 1, 0}}, camera);
  const double side = projected_size_px({-1, -1, -1}, {1, 1, 1}, {{9, 0, 0}, {-1, 0, 0}, {0, 0, 1}}, camera);
  EXPECT_DOUBLE_EQ(front, side);
}

TEST(LodChain, LetsALevelServeWhileItsEdgesAreShortOnTheScreen) {
  const auto levels = eggs();
  const LodChain chain = lod_chain(levels, {.edge_px = 10});
  ASSERT_EQ(chain.largest_px.size(), 3u);
  EXPECT_TRUE(std::isinf(chain.largest_px[0]));
  EXPECT_GT(chain.largest_px[1], chain.largest_px[2]);
  // Edges of a sphere's subdivision halve, so the limits halve: within the unevenness of the egg.
  EXPECT_NEAR(chain.largest_px[1] / chain.largest_px[2], 2, 0.2);
  const LodChain coarser = lod_chain(levels, {.edge_px = 20});
  EXPECT_DOUBLE_EQ(coarser.largest_px[1], 2 * chain.largest_px[1]);
}

TEST(LodChain, ScalesDistancesWithTheObjectAndTheField) {
  auto levels = eggs();
  const auto distances = [&](double fov) { return switch_distances(lod_chain(levels), {1920, 1080, fov}); };
  const auto near = distances(40), narrow = distances(20);
  EXPECT_EQ(near[0], 0);
  EXPECT_LT(near[1], near[2]);
  EXPECT_GT(narrow[1], near[1]) << "a narrow field shows the object larger, so it must be farther away";
  for (TriMesh& level : levels)
    for (Vec3& p : level.vertices) p *= 1000;
  const auto large = distances(40);
  EXPECT_NEAR(large[1], 1000 * near[1], 1e-6 * large[1]);
}

TEST(LodChain, AgreesWithTheSizeOnTheScreenAtItsDistances) {
  const LodChain chain = lod_chain(eggs());
  const Camera camera;
  const auto from = switch_distances(chain, camera);
  for (const double share : {0.5, 0.9, 1.1, 1.9, 2.1, 10.0}) {
    const double distance = share * from[1];
    EXPECT_EQ(level_for_distance(from, distance), level_for_size(chain, chain.diagonal * focal_px(camera) / distance))
        << share;
  }
}

TEST(LodChain, ChangesNothingWhenTheSizeTremblesAroundALimit) {
  const LodChain chain = lod_chain(eggs(), {.edge_px = 8, .hysteresis_percent = 10});
  const double limit = chain.largest_px[1];
  for (std::size_t begin : {0u, 1u}) {
    std::size_t level = begin;
    for (int n = 0; n < 50; ++n) {
      level = level_for_size(chain, limit * (n % 2 == 0 ? 0.95 : 1.05), level);
      EXPECT_EQ(level, begin);
    }
  }
  EXPECT_EQ(level_for_size(chain, limit * 0.89, 0), 1u) << "passed by more than the hysteresis";
  EXPECT_EQ(level_for_size(chain, limit * 1.11, 1), 0u);
  const std::vector<double> from{0, 10, 20};
  EXPECT_EQ(level_for_distance(from, 10.5, 0), 0u);
  EXPECT_EQ(level_for_distance(from, 9.5, 1), 1u);
  EXPECT_EQ(level_for_distance(from, 11.1, 0), 1u);
  EXPECT_EQ(level_for_distance(from, 100, 0), 2u) << "levels may be skipped";
}

TEST(LodChain, RefusesNothingToChooseFrom) {
  EXPECT_THROW(lod_chain({}), InputError);
  EXPECT_THROW(lod_chain(std::vector{TriMesh{}}), InputError);
  EXPECT_THROW(lod_chain(eggs(), {.edge_px = -1}), OptionError);
  EXPECT_THROW(switch_distances(lod_chain(eggs()), {100, 100, 180}), OptionError);
}

TEST(LodBlend, RunsThroughAllLevelsWithoutAJump) {
  // Also where limits are so close that their bands would overlap.
  for (const std::vector<double>& limits : {std::vector<double>{INFINITY, 100, 50}, {INFINITY, 100, 97}}) {
    const LodChain chain{limits, 1, {.edge_px = 8, .hysteresis_percent = 10}};
    const auto place = [&](double size) {
      const LodBlend blend = blend_for_size(chain, size);
      EXPECT_GE(blend.t, 0);
      EXPECT_LE(blend.t, 1);
      // Level 1 at t = 0 is the shape of level 2 at t = 1.
      return static_cast<double>(blend.level) + 1 - blend.t;
    };
    EXPECT_EQ(place(1000), 0);
    EXPECT_EQ(place(1), 2);
    double before = place(200);
    for (double size = 200; size > 1; size -= 0.01) {
      const double now = place(size);
      EXPECT_GE(now, before - 1e-12) << "coarser with every pixel lost";
      EXPECT_LE(now, before + 0.003) << "a pixel is a tenth of a band of ten, so 0.01 px moves t by 0.001 to 0.002";
      before = now;
    }
  }
}

/// The shapes at both ends are the levels themselves: the same volume, and no way to go from either to the other.
void expect_whole(const LodTransition& transition, const TriMesh& coarse, const TriMesh& fine) {
  EXPECT_TRUE(transition.exact);
  // All places are sums of weighted vertices near 1: rounding only.
  EXPECT_LT(start_distance(transition, coarse).largest, 1e-9);
  const TriMesh begin = at_transition(transition, 0), end = at_transition(transition, 1);
  EXPECT_NEAR(mesh::volume_mm3(begin), mesh::volume_mm3(coarse), 1e-12 * mesh::volume_mm3(coarse));
  EXPECT_NEAR(mesh::volume_mm3(end), mesh::volume_mm3(fine), 1e-12 * mesh::volume_mm3(fine));
  EXPECT_NEAR(mesh::area_mm2(end), mesh::area_mm2(fine), 1e-12 * mesh::area_mm2(fine));
  ASSERT_GE(end.vertices.size(), fine.vertices.size());
  for (std::size_t v = 0; v < fine.vertices.size(); ++v) EXPECT_EQ(end.vertices[v], fine.vertices[v]);
  EXPECT_TRUE(mesh::topology(end).closed());
}

TEST(LodTransition, FindsTheParentsOfASubdivisionAndStartsAtTheVeryShape) {
  const auto levels = eggs();
  for (std::size_t n = 0; n + 1 < levels.size(); ++n) {
    const TriMesh &fine = levels[n], &coarse = levels[n + 1];
    const LodTransition transition = lod_transition(coarse, fine);
    EXPECT_TRUE(transition.exact);
    const TriMesh begin = at_transition(transition, 0), end = at_transition(transition, 1);
    EXPECT_EQ(end.vertices, fine.vertices);
    // The coarse shape with its triangles cut in four: same volume and area, old vertices in place.
    EXPECT_NEAR(mesh::volume_mm3(begin), mesh::volume_mm3(coarse), 1e-12);
    EXPECT_NEAR(mesh::area_mm2(begin), mesh::area_mm2(coarse), 1e-12);
    for (std::size_t v = 0; v < coarse.vertices.size(); ++v) EXPECT_EQ(begin.vertices[v], coarse.vertices[v]);
    for (std::size_t v = coarse.vertices.size(); v < fine.vertices.size(); ++v) {
      const Vec3 half = at_transition(transition, 0.5).vertices[v];
      EXPECT_LE((half - (begin.vertices[v] + fine.vertices[v]) / 2).norm(), 1e-15);
    }
  }
}

TEST(LodTransition, DoesNotTakeAnyFourfoldMeshForASubdivision) {
  const auto levels = eggs();
  TriMesh shuffled = levels[0];  // the same counts, but the coarse vertices are not the first ones
  std::swap(shuffled.vertices.front(), shuffled.vertices.back());
  const auto last = static_cast<std::uint32_t>(shuffled.vertices.size() - 1);
  for (auto& t : shuffled.triangles)
    for (auto& v : t) v = v == 0 ? last : v == last ? 0 : v;
  expect_whole(lod_transition(levels[1], shuffled), levels[1], shuffled);
}

/// Two meshes of one shape that share no vertex.
struct Pair {
  TriMesh coarse, fine;
};
Pair turned_spheres() {
  Pair pair{mesh::icosphere(2), mesh::icosphere(4)};
  const Mat3 turn = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (Vec3& p : pair.fine.vertices) p = turn * p;
  return pair;
}

TEST(LodTransition, IsTheCoarseSurfaceAtItsStartForAnyOtherMesh) {
  const auto [coarse, fine] = turned_spheres();
  expect_whole(lod_transition(coarse, fine), coarse, fine);
}

void expect_whole_levels(synthetic::CloudShape shape, const std::vector<int>& triangles) {
  Options options;
  options.triangles = triangles;
  const auto levels = reconstruct(synthetic::make_cloud({.shape = shape, .points = 20000}), options).levels;
  for (std::size_t n = 0; n + 1 < levels.size(); ++n)
    expect_whole(lod_transition(levels[n + 1].mesh, levels[n].mesh), levels[n + 1].mesh, levels[n].mesh);
}

TEST(LodTransition, IsTheCoarseSurfaceAtItsStartForLevelsOfACloud) {
  expect_whole_levels(synthetic::CloudShape::blobs, {1280, 320, 80});
  expect_whole_levels(synthetic::CloudShape::torus, {1280, 320, 80});
}

TEST(LodTransition, IsTheCoarseSurfaceAtItsStartAtThinRims) {
  expect_whole_levels(synthetic::CloudShape::vase, {1280, 320});
}

TEST(LodTransition, IsMostlyTheCoarseSurfaceAtItsStartWhereSheetsNearlyTouch) {
  // Between the turns of a wire and in a handle of few triangles the nearest place jumps from one sheet to the other.
  // Whether a transition misses a part depends on the last digits of the levels: one in five did over many seeds.
  int whole = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
    for (const auto shape : {synthetic::CloudShape::spring, synthetic::CloudShape::two_torus}) {
      Options options;
      options.triangles = {1280, 320, 80};
      if (shape == synthetic::CloudShape::spring) options.triangles.pop_back();
      const auto levels =
          reconstruct(synthetic::make_cloud({.shape = shape, .points = 20000, .seed = seed}), options).levels;
      for (std::size_t n = 0; n + 1 < levels.size(); ++n, ++all) {
        const LodTransition transition = lod_transition(levels[n + 1].mesh, levels[n].mesh);
        whole += transition.exact;
        if (transition.exact)
          expect_whole(transition, levels[n + 1].mesh, levels[n].mesh);
        else
          EXPECT_GT(start_distance(transition, levels[n + 1].mesh).largest, 1e-9) << "it tells how far it is off";
      }
    }
  EXPECT_EQ(all, 18);
  EXPECT_GE(5 * whole, 3 * all);
}

TEST(LodTransition, LeavesNoTrianglesThatMeetOnTheWay) {
  Options options;
  options.triangles = {1280, 320};
  const auto levels =
      reconstruct(synthetic::make_cloud({.shape = synthetic::CloudShape::spring, .points = 20000}), options).levels;
  ASSERT_EQ(levels.size(), 2u);
  const LodTransition transition = lod_transition(levels[1].mesh, levels[0].mesh);
  std::size_t met = 0;
  for (const double t : {0.1, 0.25, 0.5, 0.75, 1.0}) {
    const FreeShape shape = free_at_transition(transition, t);
    EXPECT_TRUE(shape.check.valid()) << t;
    EXPECT_TRUE(mesh::check_surface(shape.mesh).valid()) << t;
    met += shape.met;
    const TriMesh straight = at_transition(transition, t);
    std::size_t moved = 0;
    for (std::size_t v = 0; v < straight.vertices.size(); ++v) moved += straight.vertices[v] != shape.mesh.vertices[v];
    EXPECT_LE(moved, shape.ahead);
  }
  EXPECT_GT(met, 0u) << "else this body shows nothing";
}

TEST(LodTransition, ChangesTheVolumeContinuouslyFromOneLevelToTheOther) {
  for (const Pair& pair : {turned_spheres(), Pair{eggs()[1], eggs()[0]}}) {
    const LodTransition transition = lod_transition(pair.coarse, pair.fine);
    const double begin = mesh::volume_mm3(at_transition(transition, 0)), end = mesh::volume_mm3(pair.fine);
    double before = begin;
    for (int step = 1; step <= 100; ++step) {
      const double now = mesh::volume_mm3(at_transition(transition, step / 100.0));
      EXPECT_NEAR(now, before, 0.03 * std::abs(end - begin)) << "no step is larger than three of a hundred";
      before = now;
    }
    EXPECT_NEAR(before, end, 1e-12 * end) << "cutting triangles moves the sum by rounding";
  }
}

TEST(LodTransition, StaysOnItsOwnSideOfAThinPlate) {
  // A coarse plate of which the fine one's bottom is nearer to the coarse top than to the coarse bottom.
  TriMesh coarse = mesh::cube_surface(2), fine = mesh::cube_surface(8);
  for (Vec3& p : coarse.vertices) p[2] = 0.01 * p[2] - 0.03;  // from -0.04 to -0.02
  for (Vec3& p : fine.vertices) p[2] *= 0.02;                 // from -0.02 to 0.02
  const LodTransition transition = lod_transition(coarse, fine);
  for (std::size_t v = 0; v < fine.vertices.size(); ++v)
    if (fine.vertices[v].head<2>().cwiseAbs().maxCoeff() < 0.9) {
      EXPECT_NEAR(transition.start[v][2], fine.vertices[v][2] > 0 ? -0.02 : -0.04, 1e-12);
    }
}

TEST(StartDistance, IsNothingAtAllWhereTrianglesAreCutInFour) {
  const TriMesh coarse = mesh::icosphere(1), fine = mesh::icosphere(2);
  const StartDistance cut = start_distance(lod_transition(coarse, fine), coarse);
  EXPECT_EQ(cut.mean, 0);
  EXPECT_EQ(cut.largest, 0);
}

TEST(LodTransition, RefusesMeshesWithoutTriangles) {
  EXPECT_THROW(lod_transition({}, mesh::icosphere(1)), InputError);
  EXPECT_THROW(lod_transition(mesh::icosphere(1), {}), InputError);
}

TEST(Tessellation, ComparesWithTwoTrianglesForEachPoint) {
  // Thesis 6.2.3: Venus, 134,345 points, would have 268,690; 5120 of them are 1.9 %, 1280 are 0.48 %.
  EXPECT_NEAR(share_of_plain_tessellation_percent(5120, 134345), 1.9, 0.01);
  EXPECT_NEAR(share_of_plain_tessellation_percent(1280, 134345), 0.48, 0.005);
  EXPECT_EQ(share_of_plain_tessellation_percent(5120, 0), 0);
}

}  // namespace
}  // namespace dynasurf::cloud
