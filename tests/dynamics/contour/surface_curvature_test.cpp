#include "dynasurf/dynamics/contour/detail/surface_curvature.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::dynamics {
namespace {

TriMesh sphere(int level, double radius) {
  TriMesh mesh = mesh::icosphere(level);
  for (Vec3& p : mesh.vertices) p = radius * p + Vec3(3, -1, 2);
  return mesh;
}

double largest(const std::vector<Vec3>& forces) {
  double most = 0;
  for (const Vec3& f : forces) most = std::max(most, f.norm());
  return most;
}

TEST(SurfaceCurvature, OfASphereIsOneOverItsRadius) {
  for (const double radius : {0.5, 4.0, 30.0})
    for (const double k : vertex_curvatures(sphere(3, radius)))
      EXPECT_NEAR(k * radius, 1, 2e-3);  // normals turn a little
}

TEST(SurfaceCurvatureForce, VanishesWhereCurvatureIsConstant) {
  // On a sphere of n vertices one spike of a tenth of an edge gives a force near 0.3; constant curvature gives what the
  // uneven triangles of the icosphere leave, at most a thousandth of an edge's turn.
  for (const double radius : {0.5, 4.0, 30.0}) EXPECT_LT(largest(surface_curvature_force(sphere(3, radius))), 2e-4);
  TriMesh flat;  // 5 x 5 points of a plane
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i) flat.vertices.push_back(Vec3(i, j, 0));
  for (std::uint32_t j = 0; j < 4; ++j)
    for (std::uint32_t i = 0; i < 4; ++i) {
      const std::uint32_t a = 5 * j + i;
      flat.triangles.push_back({a, a + 1, a + 6});
      flat.triangles.push_back({a, a + 6, a + 5});
    }
  EXPECT_LT(largest(surface_curvature_force(flat)), 1e-15);
  TriMesh cap = sphere(3, 10);  // its rim has no curvature to compare with
  std::erase_if(cap.triangles, [&](const auto& t) {
    return std::any_of(t.begin(), t.end(), [&](std::uint32_t v) { return cap.vertices[v].z() > 4; });
  });
  EXPECT_LT(largest(surface_curvature_force(cap)), 1e-3);
}

TEST(SurfaceCurvatureForce, PullsABumpBackAndDecaysIt) {
  TriMesh mesh = sphere(3, 10);
  const Vec3 centre(3, -1, 2), outwards = (mesh.vertices[100] - centre).normalized();
  mesh.vertices[100] += 0.3 * outwards;
  const auto height = [&] { return (mesh.vertices[100] - centre).norm() - 10; };
  EXPECT_GT(surface_curvature_force(mesh)[100].dot(-outwards), 0.1);
  for (int step = 0; step < 100; ++step) {
    const std::vector<Vec3> f = surface_curvature_force(mesh);
    for (std::size_t v = 0; v < f.size(); ++v) mesh.vertices[v] += 0.2 * f[v];
  }
  EXPECT_LT(std::abs(height()), 0.1);
  double mean = 0;
  for (const Vec3& p : mesh.vertices) mean += (p - centre).norm() / static_cast<double>(mesh.vertices.size());
  EXPECT_NEAR(mean, 10, 0.01);  // the sphere itself does not shrink
}

TEST(SurfaceCurvatureForce, DecaysABumpInARunOfEvolve) {
  TriMesh start = sphere(3, 10);
  const Vec3 centre(3, -1, 2);
  start.vertices[100] += 0.3 * (start.vertices[100] - centre).normalized();
  Grid grid;
  grid.dims = {30, 30, 30};
  grid.origin = Vec3::Zero();
  Evolution how;
  how.mass_kg = 64.2;  // 0.1 kg each: drag 1 allows RK4 steps of 0.28 s
  how.force.drag = 1;
  how.step_s = 0.1;
  how.smooth_every = 0;
  how.smooth_after.sweeps = 0;
  how.end.still_share = 1;
  how.end.still_move = 0;
  how.end.still_radius = 0;
  how.end.max_steps = 300;
  Additions own;
  const auto bump = [&](const TriMesh& mesh) { return (mesh.vertices[100] - centre).norm() - 10; };
  const auto end = [&] { return evolve(start, field::VectorField(grid), Image(grid), how, {}, own).mesh; };
  EXPECT_NEAR(bump(end()), 0.3, 1e-12);  // nothing else moves it
  own.forces.push_back(surface_curvature_force(start, 1));
  EXPECT_LT(std::abs(bump(end())), 0.1);
}

TEST(SurfaceCurvatureForce, ItsJacobianBoundsItsSlope) {
  // The largest slope by power iteration on differences of the force, against the largest one of the jacobian.
  const TriMesh mesh = sphere(2, 10);
  const Force force = surface_curvature_force(mesh, 1);
  ParticleSystem system = particles_at(mesh.vertices, static_cast<double>(mesh.vertices.size()));
  const auto force_at = [&](const std::vector<Vec3>& x) {
    std::vector<Vec3> f(x.size(), Vec3::Zero());
    force.accumulate({x, system.velocities, {}}, f);
    return f;
  };
  std::vector<Vec3> x;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) x.push_back(Vec3(v % 2, v % 3, v % 5) - Vec3(0.5, 1, 2));
  double slope = 0;
  for (int k = 0; k < 200; ++k) {
    double size = 0;
    for (const Vec3& p : x) size += p.squaredNorm();
    std::vector<Vec3> ahead = mesh.vertices, behind = mesh.vertices;
    const double step = 1e-5 / std::sqrt(size);
    for (std::size_t v = 0; v < x.size(); ++v) ahead[v] += step * x[v], behind[v] -= step * x[v];
    const auto a = force_at(ahead), b = force_at(behind);
    slope = 0;
    for (std::size_t v = 0; v < x.size(); ++v) {
      x[v] = (b[v] - a[v]) / 2e-5;
      slope += x[v].squaredNorm();
    }
    slope = std::sqrt(slope);
  }
  system.forces = {force};
  const double bound = fastest_modes(system).stiffness;  // masses of 1 kg
  EXPECT_GE(bound, slope);
  EXPECT_LT(bound, 5 * slope) << "not idly large";
}

TEST(SurfaceCurvatureForce, TurnsWithTheSurface) {
  TriMesh mesh = sphere(2, 5);
  for (Vec3& p : mesh.vertices) p.z() *= 1.7;
  TriMesh turned = mesh;
  const Mat3 rotation = Eigen::AngleAxisd(0.8, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (Vec3& p : turned.vertices) p = rotation * p;
  const auto a = surface_curvature_force(mesh), b = surface_curvature_force(turned);
  EXPECT_GT(largest(a), 0.01);
  for (std::size_t v = 0; v < a.size(); ++v) EXPECT_LT((rotation * a[v] - b[v]).norm(), 1e-12);
}

}  // namespace
}  // namespace dynasurf::dynamics
