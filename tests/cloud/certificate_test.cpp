#include "dynasurf/cloud/detail/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/detail/sample_surface.hpp"
#include "dynasurf/mesh/shapes.hpp"

#include "support/shapes.hpp"

namespace dynasurf::cloud {
namespace {

using namespace test_shapes;

PointCloud vertices_of(const TriMesh& mesh) { return {mesh.vertices, {}, {}, {}}; }

TEST(Certificate, KnowsASphereThatPassesThroughItsPoints) {
  const TriMesh ball = mesh::icosphere(3);
  const Certificate c = certify(ball, vertices_of(ball));
  EXPECT_TRUE(c.watertight());
  EXPECT_EQ(c.components, 1);
  EXPECT_EQ(c.genus, 0);
  EXPECT_EQ(c.triangles, 1280u);
  EXPECT_LT(c.cloud_to_mesh_largest, 1e-12);
  EXPECT_GT(c.smallest_angle_deg, 45);
  EXPECT_LE(c.smallest_angle_deg, c.angle_percentile_1_deg);
  EXPECT_LE(c.angle_percentile_5_deg, c.angle_mean_deg);
}

TEST(Certificate, TellsTheDistanceOfConcentricSpheres) {
  TriMesh outer = mesh::icosphere(4);
  for (Vec3& p : outer.vertices) p *= 1.1;
  const Certificate c = certify(outer, vertices_of(mesh::icosphere(4)));
  // The faces of a level 4 sphere lie up to 0.0024 inside it.
  EXPECT_NEAR(c.cloud_to_mesh_mean, 0.1, 0.003);
  EXPECT_NEAR(c.cloud_to_mesh_largest, 0.1, 0.003);
  EXPECT_GE(c.mesh_to_cloud_mean, 0.097);
  // No point of the unit sphere is farther than 0.05 from a vertex, so none of the outer one is than this.
  EXPECT_LE(c.mesh_to_cloud_largest, std::hypot(0.1, 0.05 * 1.1) + 0.003);
}

TEST(Certificate, CountsHandlesAndParts) {
  TriMesh both = torus(10, 3, 20, 10);
  EXPECT_EQ(certify(both, {}).genus, 1);
  const auto first = static_cast<std::uint32_t>(both.vertices.size());
  const TriMesh ball = mesh::icosphere(1);
  for (const Vec3& p : ball.vertices) both.vertices.push_back(Vec3(p + Vec3(50, 0, 0)));
  for (const auto& t : ball.triangles) both.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  const Certificate c = certify(both, {});
  EXPECT_EQ(c.components, 2);
  EXPECT_EQ(c.genus, 1);
}

TEST(Certificate, CountsTheLoopsOfAnOpenSurface) {
  TriMesh open = mesh::icosphere(2);
  open.triangles.pop_back();
  open.triangles.erase(open.triangles.begin());
  const Certificate c = certify(open, {});
  EXPECT_FALSE(c.closed);
  EXPECT_FALSE(c.watertight());
  EXPECT_TRUE(c.sound_open());
  EXPECT_EQ(c.boundary_loops, 2);
  EXPECT_EQ(c.genus, 0);
  EXPECT_FALSE(certify(mesh::icosphere(2), {}).sound_open());
}

TEST(Certificate, DoesNotPassAnOpenSurfaceThatIsPinched) {
  TriMesh open = mesh::icosphere(2);
  const auto tip = open.triangles[0][0];
  std::size_t taken = 0;  // every other triangle around one vertex
  for (std::size_t t = open.triangles.size(); t-- > 0;)
    if (std::count(open.triangles[t].begin(), open.triangles[t].end(), tip) > 0 && taken++ % 2 == 0)
      open.triangles.erase(open.triangles.begin() + static_cast<std::ptrdiff_t>(t));
  const Certificate c = certify(open, {});
  EXPECT_FALSE(c.manifold);
  EXPECT_FALSE(c.genus);
  EXPECT_FALSE(c.sound_open());
}

TEST(Certificate, DoesNotPassASurfaceTurnedInsideOut) {
  TriMesh ball = mesh::icosphere(2);
  for (auto& t : ball.triangles) std::swap(t[1], t[2]);
  EXPECT_TRUE(certify(ball, {}).oriented);
  EXPECT_FALSE(certify(ball, {}).watertight());
}

TEST(Certificate, DoesNotPassASurfaceThatMeetsItself) {
  TriMesh ball = mesh::icosphere(3);
  ball.vertices[0] *= -1.5;
  EXPECT_GT(certify(ball, {}).self_intersections, 0u);
  EXPECT_FALSE(certify(ball, {}).watertight());
}

TEST(Certificate, RefusesPointsThatAreNotFinite) {
  const PointCloud cloud{{Vec3(0, 0, std::numeric_limits<double>::quiet_NaN())}, {}, {}, {}};
  EXPECT_THROW(certify(mesh::icosphere(1), cloud), InputError);
}

/// Points on the unit sphere.
std::vector<Vec3> on_sphere(std::size_t count) {
  std::vector<Vec3> points;
  const TriMesh fine = mesh::icosphere(5);
  for (const mesh::SurfaceSample& p : mesh::sample_surface(fine, count))
    points.push_back(mesh::position_of(fine, p).normalized());
  return points;
}

TEST(ErrorsAtVertices, MeasureHowFarThePointsAre) {
  TriMesh mesh = mesh::icosphere(4);
  for (Vec3& p : mesh.vertices) p *= p[0] > 0 ? 1.0 : 0.9;
  const auto errors = compare(mesh, KdTree(on_sphere(20000))).errors;
  ASSERT_EQ(errors.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < errors.size(); ++v) {
    const Vec3 direction = mesh.vertices[v].normalized();
    // Edges of 0.07 leave a sagitta of 0.001.
    if (direction[0] > 0.2) {
      EXPECT_NEAR(errors[v], 0, 2e-3);
    }
    if (direction[0] < -0.2) {
      EXPECT_NEAR(errors[v], 0.1, 2e-3);
    }
  }
}

TEST(ErrorsAtVertices, SayNothingWhereThereIsNoPoint) {
  std::vector<Vec3> right = on_sphere(5000);
  std::erase_if(right, [](const Vec3& p) { return p[0] <= 0; });
  const TriMesh mesh = mesh::icosphere(3);
  const auto errors = compare(mesh, KdTree(right)).errors;
  for (std::size_t v = 0; v < errors.size(); ++v) {
    if (mesh.vertices[v][0] < -0.3) {
      EXPECT_EQ(errors[v], -1);
    }
    if (mesh.vertices[v][0] > 0.3) {
      EXPECT_GE(errors[v], 0);
    }
  }
}

TEST(Compare, GivesTheSameForAnyNumberOfThreads) {
  const TriMesh mesh = mesh::icosphere(4);
  const std::vector<Vec3> points = on_sphere(100000);  // more than are worked on at once
  const Comparison all = compare(mesh, KdTree(points));
  const ThreadLimit one(1);
  const Comparison alone = compare(mesh, KdTree(points));
  EXPECT_EQ(all.errors, alone.errors);
  EXPECT_EQ(all.certificate.cloud_to_mesh_mean, alone.certificate.cloud_to_mesh_mean);
}

}  // namespace
}  // namespace dynasurf::cloud
