#include "dynasurf/dynamics/evolve.hpp"

#include <numbers>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/dynamics/detail/field_force.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/mesh/measures.hpp"

#include "support/shapes.hpp"

namespace dynasurf::dynamics {
namespace {

using namespace test_shapes;

const SolverOptions kSolvers[] = {Euler{}, Midpoint{}, Rk4{}};
const Vec3 kCentre(92, 88, 62);

Grid hebron_grid() {
  Grid g;
  g.dims = {64, 64, 23};
  g.spacing = {2.87, 2.87, 5.74};
  return g;
}

/// A field that pulls to the sphere of radius r around the centre from both sides, as strong as a GVF.
field::VectorField pull_to_sphere(const Grid& grid, const Vec3& centre, double r) {
  field::VectorField f(grid);
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) {
        const Vec3 from = centre_of(grid, {i, j, k}) - centre;
        const double d = from.norm();
        if (d == 0) continue;
        const Vec3 v = 0.15 * std::tanh((r - d) / 5) * from / d;
        const std::size_t at = grid.index(i, j, k);
        f.x[at] = static_cast<float>(v[0]), f.y[at] = static_cast<float>(v[1]), f.z[at] = static_cast<float>(v[2]);
      }
  return f;
}

struct Scene {
  Image solid, border;
  field::VectorField field;
  TriMesh start;
  double data_volume_mm3() const { return static_cast<double>(count_non_zero(solid)) * solid.grid.voxel_volume_mm3(); }
};

Scene sphere_scene(int level, double radius = 35) {
  Scene s;
  s.solid = filled(hebron_grid(), [&](const Vec3& p) { return (p - kCentre).norm() <= radius; });
  s.border = border_of(s.solid);
  s.field = pull_to_sphere(hebron_grid(), kCentre, radius - 1.5);
  s.start = mesh::place(mesh::icosphere(level), s.border, {});
  return s;
}

Scene gvf_scene(int level, const Inside& inside) {
  Scene s;
  s.solid = filled(hebron_grid(), inside);
  s.border = border_of(s.solid);
  s.field = field::flow_field(s.border, field::Gvf{}).field;
  s.start = mesh::place(mesh::icosphere(level), s.border, {});
  return s;
}

/// A half sphere under a cylinder with a flat lid: the closed cup of a ventricle.
Inside cup(double r, double height) {
  const Vec3 c(kCentre[0], kCentre[1], 50);
  return [=](const Vec3& p) {
    const Vec3 q = p - c;
    return q[2] <= 0 ? q.norm() <= r : q.head<2>().norm() <= r && q[2] <= height;
  };
}

double share_within_one_voxel(const TriMesh& mesh, const Image& border) {
  const auto d = mesh::distances_to_border_voxels(mesh, border);
  return static_cast<double>(std::count_if(d.begin(), d.end(), [](double x) { return x < 1; })) /
         static_cast<double>(d.size());
}

Evolution without_smoothing() {
  Evolution o;
  o.smooth_every = 0;
  o.smooth_after.sweeps = 0;
  return o;
}

// --- known answers

TEST(FreeMotion, FollowsFieldAndDrag) {
  field::VectorField f(hebron_grid());
  std::fill(f.x.begin(), f.x.end(), 0.5F);
  std::fill(f.z.begin(), f.z.end(), -0.25F);
  for (const field::Sampling how : {field::Sampling::nearest, field::Sampling::trilinear, field::Sampling::neighbour}) {
    const Derivative motion = free_motion(f, {.strength = 10, .drag = 0.1, .sampling = how}, 0.5);
    const std::vector<double> y{50, 60, 70, 1, 2, 3};
    std::vector<double> dydt(6);
    motion(y, dydt);
    EXPECT_THAT(dydt, testing::Pointwise(testing::DoubleNear(1e-12),
                                         {1.0, 2.0, 3.0, 10 - 0.1 * 1 / 0.5, -0.1 * 2 / 0.5, -5 - 0.1 * 3 / 0.5}));
  }
}

TEST(FreeMotion, ReadsTheFieldAsTheSamplingDoes) {
  const field::VectorField f = pull_to_sphere(hebron_grid(), kCentre, 30);
  for (const field::Sampling how : {field::Sampling::nearest, field::Sampling::trilinear, field::Sampling::neighbour}) {
    const Derivative motion = free_motion(f, {.strength = 1, .drag = 0, .sampling = how}, 1);
    for (int n = 0; n < 500; ++n) {
      const Vec3 p(-30 + 0.51 * n, 200 - 0.37 * n, -20 + 0.33 * n), v(n % 3 - 1, n % 5 - 2, n % 7 - 3);
      const std::vector<double> y{p[0], p[1], p[2], v[0], v[1], v[2]};
      std::vector<double> dydt(6);
      motion(y, dydt);
      EXPECT_EQ(Vec3(dydt[3], dydt[4], dydt[5]), field::sample(f, p, how, v));
    }
  }
}

TEST(Evolve, ReachesTheSteadySpeedOfFieldAndDrag) {
  // One particle in a constant field: x(t) = v t - v m/k (1 - e^{-kt/m}), v = K V / k.
  Grid g;
  g.dims = {100, 3, 3};
  field::VectorField f(g);
  std::fill(f.x.begin(), f.x.end(), 0.1F);
  const TriMesh one{{{5, 1, 1}}, {}};
  Evolution o = without_smoothing();
  o.step_s = 0.05;
  o.force = {.strength = 10, .drag = 0.5};
  o.end = {.still_radius = 0, .max_steps = 200};
  const EvolutionResult r = evolve(one, f, Image(g), o);
  const double v = 10 * 0.1F / 0.5, t = 10, tau = 1 / 0.5;
  EXPECT_EQ(r.steps, 200);
  EXPECT_EQ(r.reason, StopReason::max_steps);
  EXPECT_NEAR(r.mesh.vertices[0][0], 5 + v * t - v * tau * (1 - std::exp(-t / tau)), 1e-5);  // RK4: h^5 per step
  EXPECT_EQ(r.mesh.vertices[0][1], 1);
}

TEST(Evolve, StopsAtEntryCentreOrTheLastPointBefore) {
  Grid g;
  g.dims = {40, 3, 3};
  g.spacing = {2, 2, 2};
  field::VectorField f(g);
  std::fill(f.x.begin(), f.x.end(), 0.1F);
  Image border(g);
  border(20, 1, 1) = 1;
  const TriMesh one{{{5, 2.3, 1.8}}, {}};
  Evolution o = without_smoothing();
  const auto end_of = [&](StopPoint point) {
    o.stop.point = point;
    const EvolutionResult r = evolve(one, f, border, o);
    EXPECT_EQ(r.reason, StopReason::all_stopped);
    EXPECT_EQ(r.stopped_fraction, 1);
    EXPECT_EQ(r.stopped[0], 1);
    return r.mesh.vertices[0];
  };
  EXPECT_LT((end_of(StopPoint::entry) - Vec3(39, 2.3, 1.8)).norm(), 1e-9);
  EXPECT_LT((end_of(StopPoint::centre) - Vec3(40, 2, 2)).norm(), 1e-9);
  const Vec3 before = end_of(StopPoint::backtrack);
  EXPECT_LT(before[0], 39);
  EXPECT_GT(before[0], 38);  // a step of 0.3 voxels before the face at most
}

TEST(Evolve, WrapsSphereEllipsoidAndCupWithinTheBoundsOfThePhantom) {
  // Issue bounds for the outer surface: volume within 2 % of the voxels', 97 % of particles within one voxel.
  const std::vector<std::pair<std::string, Inside>> bodies = {
      {"sphere", [](const Vec3& p) { return (p - kCentre).norm() <= 35; }},
      {"ellipsoid", [](const Vec3& p) { return (p - kCentre).cwiseQuotient(Vec3(30, 38, 45)).norm() <= 1; }},
      {"cup", cup(36.5, 56)}};
  for (const auto& [name, inside] : bodies)
    for (const int level : {3, 4}) {
      const Scene s = gvf_scene(level, inside);
      const EvolutionResult r = evolve(s.start, s.field, s.border, {});
      EXPECT_TRUE(r.reason == StopReason::at_rest || r.reason == StopReason::all_stopped) << name_of(r.reason);
      EXPECT_NEAR(mesh::volume_mm3(r.mesh) / s.data_volume_mm3(), 1, 0.02) << name << " level " << level;
      EXPECT_GE(share_within_one_voxel(r.mesh, s.border), 0.97) << name << " level " << level;
      EXPECT_TRUE(r.notes.empty());
    }
  const Scene cavity = gvf_scene(3, cup(18.5, 53));
  const EvolutionResult r = evolve(cavity.start, cavity.field, cavity.border, {});
  EXPECT_NEAR(mesh::volume_mm3(r.mesh) / cavity.data_volume_mm3(), 1, 0.05);
}

TEST(Evolve, GrowsFromInsideAsWell) {
  Scene s = sphere_scene(3);
  s.start = mesh::place(mesh::icosphere(3), s.border, {.scale = 0.3});
  const EvolutionResult r = evolve(s.start, s.field, s.border, without_smoothing());
  EXPECT_GE(r.stopped_fraction, 0.99);
  // From inside the faces towards the centre are met: one voxel less all around than from outside.
  EXPECT_LT(mesh::volume_mm3(r.mesh), s.data_volume_mm3());
  EXPECT_GE(share_within_one_voxel(r.mesh, s.border), 0.97);
}

// --- laws

TEST(Evolve, GivesTheSameBytesForAnyNumberOfThreads) {
  const Scene s = sphere_scene(4);  // 2562 particles: three pieces
  for (const SolverOptions& solver : kSolvers) {
    Evolution o;
    o.solver = solver;
    o.end.max_steps = 120;
    o.histories = true;
    std::optional<EvolutionResult> first;
    for (const int threads : {1, 2, 4, 8}) {
      const ThreadLimit limit(threads);
      const EvolutionResult r = evolve(s.start, s.field, s.border, o);
      if (!first) first = r;
      EXPECT_TRUE(same_bytes(r.mesh, first->mesh)) << threads << " threads";
      EXPECT_EQ(r.stopped, first->stopped);
      EXPECT_EQ(r.histories, first->histories);
      EXPECT_EQ(r.steps, first->steps);
    }
  }
}

TEST(Evolve, MovesEveryParticleAsIfItWereAlone) {
  const Scene s = sphere_scene(2);
  const Evolution o = without_smoothing();
  const EvolutionResult together = evolve(s.start, s.field, s.border, o);
  Evolution alone = o;
  alone.mass_kg = 1.0 / 162;
  alone.step_s = together.step_s;
  alone.end.max_steps = together.steps;
  for (std::size_t v = 0; v < 162; v += 7) {
    const EvolutionResult r = evolve({{s.start.vertices[v]}, {}}, s.field, s.border, alone);
    EXPECT_EQ(r.mesh.vertices[0], together.mesh.vertices[v]);
  }
}

TEST(Evolve, TakesNoParticleThroughTheBorderHoweverLongTheStep) {
  // The shell is thin, the pull strong, the field changes sign inside: without the walk they would jump across.
  for (const bool smoothing : {false, true})
    for (const double step : {0.0, 0.01, 0.03, 0.04})
      for (const double strength : {10.0, 100.0, 1000.0}) {
        Scene s = sphere_scene(3);
        Evolution o = smoothing ? Evolution{} : without_smoothing();
        o.smooth_after.sweeps = 0;
        o.step_s = step;
        o.force.strength = strength;
        o.end.max_steps = 600;
        const EvolutionResult r = evolve(s.start, s.field, s.border, o);
        // Nobody is in a voxel inside the shell, that is, in a voxel of the solid that is not its border; the
        // entry point itself may fall on the far side of a face by rounding, so step back to the outside a little.
        for (const Vec3& p : r.mesh.vertices) {
          const Index3 v = voxel_of(s.solid.grid, p + 1e-6 * (p - kCentre));
          ASSERT_TRUE(s.solid(v[0], v[1], v[2]) == 0 || s.border(v[0], v[1], v[2]) != 0)
              << "step " << step << " strength " << strength << " smoothing " << smoothing;
        }
      }
}

TEST(Evolve, StopsAParticleThatSmoothingWouldPullThroughTheBorder) {
  // No field: only the smoothing moves the tip of a spike, down through a layer of border voxels at z = 13 to 15.
  Grid g;
  g.dims = {16, 16, 16};
  g.spacing = {2, 2, 2};
  Image border(g);
  for (int j = 0; j < 16; ++j)
    for (int i = 0; i < 16; ++i) border(i, j, 7) = 1;
  TriMesh spike = mapped(sheet(8), [](const Vec3& p) { return Vec3(6 + 2 * p[0], 6 + 2 * p[1], 10); });
  spike.vertices[40][2] = 20;
  Evolution o;
  o.smooth_after.sweeps = 0;
  const EvolutionResult r = evolve(spike, field::VectorField(g), border, o);
  EXPECT_EQ(r.stopped[40], 1);
  EXPECT_NEAR(r.mesh.vertices[40][2], 15, 1e-9);
}

TEST(Evolve, IsUnorderedWithoutStopAndSmoothing) {
  // Thesis fig. 5.2: particles run on and gather; the triangles degenerate.
  const Scene s = gvf_scene(3, cup(36.5, 56));
  Evolution free = without_smoothing();
  free.stop.enabled = false;
  free.end.max_steps = 2000;
  const mesh::TriangleQuality loose = mesh::triangle_quality(evolve(s.start, s.field, s.border, free).mesh);
  const mesh::TriangleQuality held = mesh::triangle_quality(evolve(s.start, s.field, s.border, {}).mesh);
  EXPECT_LT(loose.shape_mean, 0.8 * held.shape_mean);
}

TEST(Evolve, CountsParticlesNearTheBorderPerStep) {
  const Scene s = sphere_scene(2);
  Evolution o;
  o.histories = true;
  o.smooth_after.sweeps = 0;
  const EvolutionResult r = evolve(s.start, s.field, s.border, o);
  ASSERT_EQ(r.histories.size(), static_cast<std::size_t>(r.steps));
  for (const auto& h : r.histories) {
    EXPECT_LE(h[0], h[1]);
    EXPECT_LE(h[1], h[2]);
    EXPECT_EQ(h[2] + h[3], 162);
  }
  EXPECT_LT(r.histories.front()[2], 20);
  const auto d = mesh::distances_to_border_voxels(r.mesh, s.border);
  for (int n = 0; n < 3; ++n)
    EXPECT_EQ(r.histories.back()[static_cast<std::size_t>(n)],
              std::count_if(d.begin(), d.end(), [&](double x) { return x < n + 1; }));
}

TEST(Evolve, KeepsWhereParticlesWereAndHowTheyWerePulled) {
  const Scene s = sphere_scene(2);
  Evolution o = without_smoothing();
  o.trajectory_every = 7;
  const EvolutionResult r = evolve(s.start, s.field, s.border, o);
  ASSERT_GT(r.trajectory.size(), 3u);
  EXPECT_EQ(r.trajectory.front().places, s.start.vertices);
  EXPECT_EQ(r.trajectory.back().step, r.steps);
  EXPECT_EQ(r.trajectory.back().places, r.mesh.vertices);
  for (std::size_t n = 0; n + 1 < r.trajectory.size(); ++n) EXPECT_EQ(r.trajectory[n].step, static_cast<int>(7 * n));
  double longest = 0;
  for (const Vec3& pull : r.trajectory.front().pulls) longest = std::max(longest, pull.norm());
  EXPECT_NEAR(longest, o.force.strength * 0.15, 0.01);  // the scene's field
  for (std::size_t v = 0; v < r.stopped.size(); ++v)
    EXPECT_TRUE(r.stopped[v] == 0 || r.trajectory.back().pulls[v].isZero()) << v;
  o.trajectory_every = r.steps;
  EXPECT_EQ(evolve(s.start, s.field, s.border, o).trajectory.size(), 2u)
      << "the last step once, though it is asked for";
  EXPECT_TRUE(evolve(s.start, s.field, s.border, without_smoothing()).trajectory.empty());
}

TEST(Evolve, ChoosesAStepBelowTheLimitAndBelowHalfAVoxel) {
  for (const SolverOptions& solver : kSolvers)
    for (const int level : {2, 3}) {
      const Scene s = sphere_scene(level);
      Evolution o = without_smoothing();
      o.solver = solver;
      const EvolutionResult r = evolve(s.start, s.field, s.border, o);
      EXPECT_LE(r.step_s, 0.8 * step_limit_s(solver, 1, s.start.vertices.size(), 0.1) * (1 + 1e-12));
      EXPECT_TRUE(r.notes.empty());
      EXPECT_GE(r.stopped_fraction, 0.99);
    }
}

TEST(Evolve, MovesWithoutDragByDisplacementAlone) {
  const Scene s = sphere_scene(2);
  Evolution o = without_smoothing();
  o.force = {.strength = 0.1, .drag = 0};
  const EvolutionResult r = evolve(s.start, s.field, s.border, o);
  EXPECT_EQ(r.stopped_fraction, 1);
  EXPECT_TRUE(r.notes.empty());
  EXPECT_LT(r.steps, 3000);
}

TEST(Evolve, KeepsTheTrianglesOfTheStart) {
  const Scene s = sphere_scene(2);
  EXPECT_EQ(evolve(s.start, s.field, s.border, {}).mesh.triangles, s.start.triangles);
}

// --- hard data

TEST(Evolve, EndsWithStragglersThatNeverMeetTheBorder) {
  // A border with a hole: some particles go through it and drift inside, some are held off by their neighbours.
  Scene s = sphere_scene(3);
  for (int k = 0; k < 23; ++k)
    for (int j = 0; j < 64; ++j)
      for (int i = 38; i < 64; ++i) s.border(i, j, k) = 0;
  Evolution o;
  o.end.still_share = 1;
  const EvolutionResult r = evolve(s.start, s.field, s.border, o);
  EXPECT_GT(r.stopped_fraction, 0.5);
  EXPECT_LT(r.stopped_fraction, 0.95);
  EXPECT_NE(r.reason, StopReason::diverged);
  EXPECT_LE(r.steps, o.end.max_steps);
}

TEST(Evolve, CountsParticlesThatTrembleAsAtRest) {
  // Field and smoothing pull some particles to and fro: without `still_radius` the run lasts to its last step.
  const Scene s = gvf_scene(3, [](const Vec3& p) { return (p - kCentre).norm() <= 35; });
  Evolution o;
  EXPECT_EQ(evolve(s.start, s.field, s.border, o).reason, StopReason::at_rest);
  o.end.still_radius = 0;
  EXPECT_EQ(evolve(s.start, s.field, s.border, o).reason, StopReason::max_steps);
}

TEST(Evolve, GoesByABandAsByTheFieldOfEveryVoxel) {
  // Starts outside the band, reads coarser cells there, and the nearest voxel outside the grid.
  const Scene s = gvf_scene(3, [](const Vec3& p) { return (p - kCentre).norm() <= 35; });
  const field::BandField band = field::band_field(s.border, field::BandGvf{}).field;
  const field::VectorField dense = field::dense_field(band);
  TriMesh start = s.start;
  for (Vec3& p : start.vertices) p = kCentre + 2.5 * (p - kCentre);
  for (const field::Sampling sampling : {field::Sampling::nearest, field::Sampling::trilinear})
    for (const ModelOptions& model : {ModelOptions(FreeModel{}), ModelOptions(RestrictedSpringModel{})}) {
      Evolution o;
      o.model = model;
      o.damping = FieldDrag{};
      o.force.sampling = sampling;
      o.end.max_steps = 60;
      const EvolutionResult near = evolve(start, band, s.border, o), full = evolve(start, dense, s.border, o);
      double moved = 0;
      for (std::size_t v = 0; v < start.vertices.size(); ++v) {
        ASSERT_LT((near.mesh.vertices[v] - full.mesh.vertices[v]).norm(), 1e-6);
        moved = std::max(moved, (near.mesh.vertices[v] - start.vertices[v]).norm());
      }
      EXPECT_GT(moved, 0.1);  // far out the field is weak
    }
}

TEST(Evolve, ClosesASurfaceInABigVolumeThroughABandAlone) {
  Grid grid;
  grid.dims = {200, 180, 190};
  const Vec3 centre(95, 92, 90);
  Image border(grid);
  std::vector<Index3> voxels;
  for (int k = 0; k < 190; ++k)
    for (int j = 0; j < 180; ++j)
      for (int i = 0; i < 200; ++i) {
        const double r = (Vec3(i, j, k) - centre).norm();
        if (r > 50 || r <= 49) continue;
        border(i, j, k) = 1;
        voxels.push_back({i, j, k});
      }
  const field::BandField band = field::band_field(grid, voxels, field::BandGvf{}).field;
  EXPECT_LT(band.bytes(), grid.size() * 12 / 5) << "a fifth of the field of every voxel";
  Evolution o;
  o.force.strength = 25;
  const EvolutionResult r = evolve(mesh::place(mesh::icosphere(3), border, {}), band, border, o);
  EXPECT_TRUE(r.reason == StopReason::all_stopped || r.reason == StopReason::at_rest) << name_of(r.reason);
  EXPECT_GT(r.stopped_fraction, 0.99);
  EXPECT_NEAR(mesh::volume_mm3(r.mesh) / (4.0 / 3 * std::numbers::pi * 50 * 50 * 50), 1, 0.03);  // 642 vertices: -0.9 %
}

TEST(Evolve, EndsSoonInAFieldOfZeros) {
  Scene s = sphere_scene(2);
  s.field = field::VectorField(hebron_grid());
  const EvolutionResult r = evolve(s.start, s.field, s.border, without_smoothing());
  EXPECT_EQ(r.reason, StopReason::at_rest);
  EXPECT_EQ(r.steps, 10);
  EXPECT_TRUE(same_bytes(r.mesh, s.start));
}

TEST(Evolve, DoesNotTakeAShortStepForRest) {
  // In steps of a thousandth of the automatic one every move is tiny from the first step on.
  const Scene s = sphere_scene(2);
  Evolution o = without_smoothing();
  o.step_s = 5e-5;
  o.end.max_steps = 200;
  EXPECT_EQ(evolve(s.start, s.field, s.border, o).reason, StopReason::max_steps);
  // Nor the slow beginning of one that is shorter still, in which particles have no speed yet.
  o.step_s /= 1000;
  const EvolutionResult begun = evolve(s.start, s.field, s.border, o);
  EXPECT_EQ(begun.reason, StopReason::max_steps) << begun.steps << " steps";
}

TEST(Evolve, ReportsDivergenceWithTheLastGoodMesh) {
  const Scene s = sphere_scene(2);
  for (const SolverOptions& solver : kSolvers) {
    Evolution o = without_smoothing();
    o.solver = solver;
    o.stop.enabled = false;
    o.step_s = 1.3 * step_limit_s(solver, 1, 162, 0.1);
    const EvolutionResult r = evolve(s.start, s.field, s.border, o);
    EXPECT_EQ(r.reason, StopReason::diverged);
    EXPECT_LT(r.steps, 200);
    for (const Vec3& p : r.mesh.vertices) {
      EXPECT_TRUE(p.allFinite());
      EXPECT_LT((p - kCentre).norm(), 500);
    }
    ASSERT_GE(r.notes.size(), 2U);
    EXPECT_EQ(r.notes.front().code, "evolve.step_above_limit");
    EXPECT_EQ(r.notes.back().code, "evolve.diverged");
    o.step_s = 0.95 * step_limit_s(solver, 1, 162, 0.1);
    o.end.max_steps = 500;
    EXPECT_NE(evolve(s.start, s.field, s.border, o).reason, StopReason::diverged);
  }
}

TEST(Evolve, SaysWhenAParticleIsFast) {
  const Scene s = sphere_scene(2);
  Evolution o = without_smoothing();
  o.step_s = 0.12;
  const EvolutionResult r = evolve(s.start, s.field, s.border, o);
  ASSERT_EQ(r.notes.size(), 1U);
  EXPECT_EQ(r.notes[0].code, "evolve.fast_particle");
}

TEST(Evolve, LetsParticlesInFromOutsideTheGridAndNoneOut) {
  Scene s = sphere_scene(2, 60);  // the ellipsoid around it leaves the grid
  const double low = std::accumulate(s.start.vertices.begin(), s.start.vertices.end(), 1e9,
                                     [](double m, const Vec3& p) { return std::min(m, p[2]); });
  ASSERT_LT(low, -6);
  EXPECT_EQ(evolve(s.start, s.field, s.border, without_smoothing()).stopped_fraction, 1);
  field::VectorField outwards(hebron_grid());
  std::fill(outwards.x.begin(), outwards.x.end(), 0.2F);
  const EvolutionResult r = evolve(sphere_scene(2).start, outwards, Image(hebron_grid()), without_smoothing());
  EXPECT_EQ(r.reason, StopReason::at_rest);
  for (const Vec3& p : r.mesh.vertices) EXPECT_NEAR(p[0], 63.5 * 2.87, 1e-9);
}

TEST(Evolve, LeavesNoSpeedToAParticleAtTheWall) {
  // Else it would stay there until a force had eaten up what it gained on the way.
  Grid g;
  g.dims = {10, 3, 3};
  field::VectorField f(g);
  std::fill(f.x.begin(), f.x.end(), 0.1F);
  Evolution o = without_smoothing();
  o.step_s = 0.05;
  o.force = {.strength = 10, .drag = 0.5};
  o.end = {.still_share = 1, .still_radius = 0, .max_steps = 400};
  double speed = 0;
  Additions own;
  own.forces.push_back({"watch", [&](const ParticleState& state, std::span<Vec3>) { speed = state.velocities[0][0]; }});
  const EvolutionResult r = evolve({{{5, 1, 1}}, {}}, f, Image(g), o, {}, own);
  EXPECT_DOUBLE_EQ(r.mesh.vertices[0][0], 9.5);
  EXPECT_LT(speed, 10 * 0.1 * 0.05 * 1.01);  // what the last step gave
}

TEST(Evolve, StartsInsideTheBorderStoppedWhereItIs) {
  Scene s = sphere_scene(2);
  std::fill(s.border.values.begin(), s.border.values.end(), 1.0F);
  s.start = mesh::place(mesh::icosphere(2), s.border, {.scale = 0.5});
  const EvolutionResult r = evolve(s.start, s.field, s.border, without_smoothing());
  EXPECT_EQ(r.reason, StopReason::all_stopped);
  EXPECT_EQ(r.steps, 1);
  EXPECT_TRUE(same_bytes(r.mesh, s.start));
}

// --- bad input

TEST(Evolve, RefusesWhatCannotMove) {
  const Scene s = sphere_scene(2);
  EXPECT_THROW(evolve({}, s.field, s.border, {}), InputError);
  Grid other = hebron_grid();
  other.dims[2] = 24;
  EXPECT_THROW(evolve(s.start, s.field, Image(other), {}), InputError);
  EXPECT_THROW(evolve(s.start, field::VectorField{}, Image(), {}), InputError);
  Scene broken = s;
  broken.start.vertices[3][1] = std::nan("");
  EXPECT_THROW(evolve(broken.start, s.field, s.border, {}), InputError);
  broken = s;
  broken.field.y[777] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(evolve(s.start, broken.field, s.border, {}), InputError);
  Evolution o;
  o.mass_kg = 0;
  EXPECT_THROW(evolve(s.start, s.field, s.border, o), OptionError);
  o = {};
  o.smooth_during.tolerance_rad = -1;
  EXPECT_THROW(evolve(s.start, s.field, s.border, o), OptionError);
}

TEST(Evolve, StopsOnRequest) {
  const Scene s = sphere_scene(2);
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(evolve(s.start, s.field, s.border, {}, {.report = {}, .stop = source.get_token()}), Cancelled);
}

}  // namespace
}  // namespace dynasurf::dynamics
