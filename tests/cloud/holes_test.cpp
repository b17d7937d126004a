#include "dynasurf/cloud/detail/holes.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "dynasurf/cloud/detail/body.hpp"
#include "dynasurf/cloud/detail/flat_lids.hpp"
#include "dynasurf/cloud/detail/indicator_field.hpp"
#include "dynasurf/cloud/detail/patch.hpp"
#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/mesh/intersections.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"

namespace dynasurf::cloud {
namespace {

using std::numbers::pi;

/// The triangles of a mesh whose middle `stays`, with the vertices that they use.
template <class Stays>
TriMesh part_of(const TriMesh& mesh, const Stays& stays) {
  TriMesh part;
  std::vector<int> id(mesh.vertices.size(), -1);
  for (const auto& t : mesh.triangles) {
    if (!stays(Vec3((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3))) continue;
    auto corners = t;
    for (auto& v : corners) {
      if (id[v] < 0) {
        id[v] = static_cast<int>(part.vertices.size());
        part.vertices.push_back(mesh.vertices[v]);
      }
      v = static_cast<std::uint32_t>(id[v]);
    }
    part.triangles.push_back(corners);
  }
  return part;
}

constexpr double large = 1, small = 0.3;

/// A piece of a torus, from angle 0 to `until`.
TriMesh torus_piece(double until) {
  constexpr int sides = 24;
  const int rings = static_cast<int>(until / (2 * pi) * 80);
  TriMesh mesh;
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s < sides; ++s) {
      const double u = until * r / rings, v = 2 * pi * s / sides, across = large + small * std::cos(v);
      mesh.vertices.push_back({across * std::cos(u), across * std::sin(u), small * std::sin(v)});
    }
  const auto id = [](int r, int s) { return static_cast<std::uint32_t>(r * sides + s % sides); };
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < sides; ++s) {
      mesh.triangles.push_back({id(r, s), id(r + 1, s), id(r + 1, s + 1)});
      mesh.triangles.push_back({id(r, s), id(r + 1, s + 1), id(r, s + 1)});
    }
  return mesh;
}

double off_torus(const Vec3& p) { return std::abs(std::hypot(std::hypot(p[0], p[1]) - large, p[2]) - small); }

template <class Off>
double largest_off(const Patch& patch, const Off& off) {
  double largest = 0;
  for (auto v = patch.first_vertex; v < patch.surface.vertex_slots(); ++v)
    largest = std::max(largest, off(patch.surface.position(v)));
  return largest;
}

TEST(LoopsOf, GoAroundEveryHoleOnce) {
  const TriMesh open = part_of(mesh::icosphere(3), [](const Vec3& p) { return std::abs(p[2]) < 0.8; });
  const std::vector<Loop> loops = loops_of(open);
  ASSERT_EQ(loops.size(), 2u);
  EXPECT_EQ(loops[0].size() + loops[1].size(), mesh::topology(open).boundary_edges);
  EXPECT_TRUE(loops_of(mesh::icosphere(2)).empty());
}

TEST(RimsOf, AimAlongATubeAndNowhereInAPlane) {
  const TriMesh tube = torus_piece(1.5 * pi);
  const std::vector<Rim> ends = rims_of(tube, loops_of(tube));
  ASSERT_EQ(ends.size(), 2u);
  EXPECT_LT((ends[0].aim - Vec3(0, -1, 0)).norm(), 0.05);  // backwards from angle 0
  EXPECT_LT((ends[0].middle - Vec3(large, 0, 0)).norm(), 0.05);
  EXPECT_NEAR(ends[0].length, 2 * pi * small, 0.02);
  const TriMesh wall =
      part_of(mesh::cube_surface(20), [](const Vec3& p) { return p[2] < 0.9 || p.head<2>().norm() > 0.4; });
  EXPECT_LT(rims_of(wall, loops_of(wall)).at(0).aim.norm(), 0.05);
}

TEST(MakePatch, GivesASphereItsCapBack) {
  const TriMesh open = part_of(mesh::icosphere(4), [](const Vec3& p) { return p[2] < 0.5; });
  const std::vector<Loop> loops = loops_of(open);
  const Patch cap = make_patch(open, loops, 0);
  // A flat lid would be 0.5 off in its middle.
  EXPECT_LT(largest_off(cap, [](const Vec3& p) { return std::abs(p.norm() - 1); }), 0.05);
  // The squared mean curvature, 1, over the cap's area of pi.
  EXPECT_NEAR(cap.bending, pi, 0.1 * pi);
  const mesh::Topology whole = mesh::topology(cap.surface.mesh());
  EXPECT_TRUE(whole.closed() && whole.oriented());
  EXPECT_EQ(whole.euler, 2);
}

TEST(MakeFlatLid, LiesInThePlaneOfItsRim) {
  const TriMesh ball = mesh::icosphere(4);
  TriMesh open = part_of(ball, [](const Vec3& p) { return p[2] < 0.5; });
  const std::vector<Loop> loops = loops_of(open);
  for (const std::uint32_t v : loops[0])
    open.vertices[v] =
        std::sqrt(0.75) * Vec3(open.vertices[v][0], open.vertices[v][1], 0).normalized() + Vec3(0, 0, 0.5);
  const Patch lid = make_flat_lid(open, loops, 0);
  EXPECT_LT(largest_off(lid, [](const Vec3& p) { return std::abs(p[2] - 0.5); }), 1e-9);
  EXPECT_GT(lid.surface.vertex_slots() - lid.first_vertex, 100u) << "triangles as large as those around";
  const mesh::Topology whole = mesh::topology(lid.surface.mesh());
  EXPECT_TRUE(whole.closed() && whole.oriented());
  EXPECT_EQ(whole.euler, 2);
}

// The rim turns inwards between the lobes, and goes up and down with the triangles that were cut away.
TEST(WithFlatLids, CrossesNothingOverARaggedRimOfThreeLobes) {
  TriMesh dome = part_of(mesh::icosphere(5), [](const Vec3& p) { return p[2] > 0; });
  for (Vec3& v : dome.vertices) v.head<2>() *= 1 + 0.15 * std::sin(3 * std::atan2(v[1], v[0]));
  const ClosedSurface closed = with_flat_lids(dome);
  const mesh::Topology whole = mesh::topology(closed.mesh);
  EXPECT_TRUE(whole.closed() && whole.oriented());
  EXPECT_TRUE(mesh::self_intersections(closed.mesh).free());
  EXPECT_EQ(closed.added.points.size(), closed.mesh.triangles.size() - dome.triangles.size());
  for (const Vec3& normal : closed.added.normals) EXPECT_LT(normal[2], 0);
}

TEST(MakePatch, JoinsTheEndsOfATornRing) {
  const TriMesh open = torus_piece(1.6 * pi);
  const std::vector<Loop> loops = loops_of(open);
  const Patch tube = make_patch(open, loops, 0, 1);
  // Half of the radius: the gap is more than two diameters long, and nothing in it tells how wide the tube is.
  EXPECT_LT(largest_off(tube, off_torus), 0.5 * small);
  EXPECT_EQ(mesh::topology(tube.surface.mesh()).euler, 0);
  // Two ends bend as much as a ball at least: 4 pi, less what the rims have turned already.
  const double ends = make_patch(open, loops, 0).bending + make_patch(open, loops, 1).bending;
  EXPECT_GT(ends, 3 * pi);
  EXPECT_LT(tube.bending, 0.6 * ends);
}

HoleFill filled(synthetic::CloudShape shape, bool may_join, int points = 20000, int cells = 72,
                std::uint64_t seed = 1) {
  const PointCloud cloud =
      synthetic::make_cloud({.shape = shape, .points = points, .missing_percent = 20, .normals = true, .seed = seed});
  const OrientedPoints oriented = orient(cloud, true);
  const IndicatorField field = solve_indicator(oriented, {.cells = cells}).back();
  Eigen::AlignedBox3d box;
  for (const Vec3& p : cloud.points) box.extend(p);
  const double reach = 0.02 * box.diagonal().norm() * std::sqrt(20000.0 / points);
  const auto fill = fill_holes(field, oriented, {.reach = reach, .spacing = 0.5 * reach, .may_join = may_join});
  if (!fill) return {};
  EXPECT_GT(fill->points.points.size(), 100u);
  return *fill;
}

TEST(FillHoles, JoinsWhatWasOneRing) {
  const HoleFill fill = filled(synthetic::CloudShape::torus, true);
  EXPECT_EQ(fill.joined, 1);
  EXPECT_EQ(fill.holes, 0);
  EXPECT_EQ(fill.kind, (BodyTopology{1, 1}));
}

// The hole takes two turns apart: five ends, of which only two pairs may be joined, or the wire goes round in a ring.
TEST(FillHoles, JoinsThePiecesOfASpringInOneLine) {
  for (const std::uint64_t seed : {2u, 3u}) {
    const HoleFill fill = filled(synthetic::CloudShape::spring, true, 50000, 86, seed);
    EXPECT_EQ(fill.joined, 2) << seed;
    EXPECT_EQ(fill.kind, (BodyTopology{1, 0})) << seed;
  }
}

TEST(FillHoles, MakesNoHandleWhereNoneMayBe) {
  const HoleFill fill = filled(synthetic::CloudShape::torus, false);
  EXPECT_EQ(fill.joined, 0);
  EXPECT_EQ(fill.holes, 2);
  EXPECT_EQ(fill.kind, (BodyTopology{1, 0}));
}

TEST(FillHoles, MendsBothSidesOfAWallApart) {
  const HoleFill fill = filled(synthetic::CloudShape::vase, true, 40000, 100);
  EXPECT_EQ(fill.joined, 0);
  EXPECT_EQ(fill.holes, 2);
}

// Both sides of the wall come to an end in one height, and no tube can join them: closed apart, the inner one would be
// a bubble within the other.
TEST(FillHoles, LeavesTheRimOfAPotWhoseUpperHalfIsMissing) {
  PointCloud cloud = synthetic::make_cloud({.shape = synthetic::CloudShape::vase, .points = 50000});
  std::erase_if(cloud.points, [](const Vec3& p) { return p[2] > 0.1; });
  Options options;
  options.triangles = {1280};
  const Result result = reconstruct(cloud, options);
  const Certificate& c = result.levels.at(0).certificate;
  EXPECT_TRUE(c.watertight());
  EXPECT_EQ(c.components, 1);
  EXPECT_EQ(c.genus, 0);
}

TEST(FillHoles, LeavesAWholeSphereAlone) {
  const PointCloud cloud =
      synthetic::make_cloud({.shape = synthetic::CloudShape::sphere, .points = 6000, .normals = true});
  const OrientedPoints oriented = orient(cloud, true);
  EXPECT_FALSE(fill_holes(solve_indicator(oriented, {.cells = 32}).back(), oriented, {.reach = 0.15, .spacing = 0.05}));
}

class TornScan : public testing::TestWithParam<synthetic::CloudShape> {};

TEST_P(TornScan, KeepsItsHandlesAndParts) {
  const PointCloud cloud = synthetic::make_cloud({.shape = GetParam(), .points = 40000, .missing_percent = 20});
  Options options;
  options.triangles = {1280};
  const Result result = reconstruct(cloud, options);
  const Certificate& c = result.levels.at(0).certificate;
  EXPECT_TRUE(c.watertight());
  EXPECT_EQ(c.components, 1);
  EXPECT_EQ(c.genus, synthetic::genus_of(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Shapes, TornScan,
                         testing::Values(synthetic::CloudShape::torus, synthetic::CloudShape::two_torus,
                                         synthetic::CloudShape::vase, synthetic::CloudShape::spring),
                         [](const auto& shape) { return std::string(word_of(shape.param)); });

}  // namespace
}  // namespace dynasurf::cloud
