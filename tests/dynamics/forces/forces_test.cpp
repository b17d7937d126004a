#include "dynasurf/dynamics/forces/forces.hpp"

#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/dynamics/solvers/solver.hpp"

#include "support/shapes.hpp"

namespace dynasurf::dynamics {
namespace {

using namespace test_shapes;

// --- the laws of all internal forces, on a family of meshes

struct State {
  std::vector<Vec3> x, v;
  operator ParticleState() const { return {x, v}; }
};

/// Uniform in [-1, 1], the same on every machine.
class Random {
 public:
  double operator()() { return engine_() / 2147483648.0 - 1; }
  Vec3 vector() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }

 private:
  std::mt19937 engine_{11};
};

double mean_edge(const TriMesh& m) {
  double sum = 0;
  const auto springs = springs_of(m);
  for (const Spring& s : springs) sum += s.rest_mm;
  return sum / static_cast<double>(springs.size());
}

/// The mesh pressed together and shaken, so that every condition is violated, and moving.
State shaken(const TriMesh& m, Random& random) {
  State s;
  const double edge = mean_edge(m);
  for (const Vec3& p : m.vertices) {
    s.x.push_back(0.9 * p + 0.04 * edge * random.vector());
    s.v.push_back(edge * random.vector());
  }
  return s;
}

struct InternalForce {
  std::string name;
  std::function<Force(const TriMesh&, double stiffness, double damping)> make;
};

std::vector<InternalForce> internal_forces() {
  return {
      {"stretch", [](const TriMesh& m, double k,
                     double d) { return stretch_force(m, {.stiffness = k, .damping = d, .rest_scale = 0.95}); }},
      {"shear", [](const TriMesh& m, double k, double d) { return shear_force(m, {.stiffness = k, .damping = d}); }},
      {"bend from the start",
       [](const TriMesh& m, double k, double d) { return bend_force(m, {.stiffness = k, .damping = d}); }},
      {"bend from flat",
       [](const TriMesh& m, double k, double d) {
         return bend_force(m, {.stiffness = k, .damping = d, .rest = BendRest::flat});
       }},
      {"bend from a zone",
       [](const TriMesh& m, double k, double d) {
         return bend_force(
             m, {.stiffness = k, .damping = d, .rest = BendRest::zone, .zone_low_rad = 0.2, .zone_high_rad = 0.21});
       }},
      {"spring", [](const TriMesh& m, double k, double d) {
         return spring_force(springs_of(m, 0.97), {.stiffness = k, .damping = d});
       }}};
}

std::vector<Vec3> force_at(const Force& force, const ParticleState& s) {
  std::vector<Vec3> f(s.positions.size(), Vec3::Zero());
  force.accumulate(s, f);
  return f;
}

double norm_of(const std::vector<Vec3>& f) {
  double sum = 0;
  for (const Vec3& v : f) sum += v.squaredNorm();
  return std::sqrt(sum);
}

double distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum);
}

double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

std::vector<Vec3> plus(std::vector<Vec3> a, double way, const std::vector<Vec3>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += way * b[i];
  return a;
}

std::vector<Vec3> random_direction(std::size_t n, Random& random) {
  std::vector<Vec3> d(n);
  for (Vec3& v : d) v = random.vector();
  return d;
}

enum class By { place, speed };
std::vector<Vec3> product(const ForceJacobian& j, By by, const std::vector<Vec3>& d) {
  std::vector<Vec3> y(d.size(), Vec3::Zero());
  for (std::size_t r = 0; r < d.size(); ++r)
    for (std::size_t k = 0; k < j.rows()[r].columns.size(); ++k)
      y[r] += (by == By::place ? j.rows()[r].dfdx[k] : j.rows()[r].dfdv[k]) * d[j.rows()[r].columns[k]];
  return y;
}

/// Calls body(mesh, force maker, state, mesh size) for every mesh and internal force.
void for_all(const std::function<void(const NamedMesh&, const InternalForce&, const State&, Random&)>& body) {
  Random random;
  for (const NamedMesh& m : closed_meshes()) {
    if (m.mesh.vertices.size() > 1000) continue;  // the smaller ones tell the same
    for (const InternalForce& f : internal_forces()) {
      SCOPED_TRACE(f.name + " on " + m.name);
      body(m, f, shaken(m.mesh, random), random);
    }
  }
}

// Central differences with steps of 1e-5 edges are good to 1e-9 or so where the mesh is not thin: 1e-6 has room.
constexpr double kDifference = 1e-5;

TEST(InternalForces, AreMinusTheSlopeOfTheirEnergy) {
  for_all([](const NamedMesh& m, const InternalForce& f, const State& s, Random& random) {
    const Force force = f.make(m.mesh, 7, 0);
    const auto d = random_direction(s.x.size(), random);
    const double h = kDifference * mean_edge(m.mesh) * (m.name == "flat ellipsoid" ? 0.01 : 1);
    const double slope =
        (force.energy(State{plus(s.x, h, d), s.v}) - force.energy(State{plus(s.x, -h, d), s.v})) / (2 * h);
    const auto at = force_at(force, s);
    EXPECT_GT(norm_of(at), 0);
    EXPECT_NEAR(-dot(at, d), slope, 1e-6 * norm_of(at) * norm_of(d));
  });
}

TEST(InternalForces, HaveTheJacobianOfFiniteDifferences) {
  for_all([](const NamedMesh& m, const InternalForce& f, const State& s, Random& random) {
    const double h = kDifference * mean_edge(m.mesh) * (m.name == "flat ellipsoid" ? 0.01 : 1);
    const auto d = random_direction(s.x.size(), random);
    const Force elastic = f.make(m.mesh, 7, 0);
    ForceJacobian j(s.x.size(), false);
    elastic.jacobian(s, j);
    auto differences =
        plus(force_at(elastic, State{plus(s.x, h, d), s.v}), -1, force_at(elastic, State{plus(s.x, -h, d), s.v}));
    for (Vec3& v : differences) v /= 2 * h;
    const auto exact = product(j, By::place, d);
    EXPECT_LT(distance(exact, differences), 1e-6 * norm_of(exact));

    const Force damped = f.make(m.mesh, 7, 3);
    ForceJacobian with_damping(s.x.size(), false);
    damped.jacobian(s, with_damping);
    auto by_speed = plus(force_at(damped, State{s.x, plus(s.v, 1, d)}), -1, force_at(damped, s));
    const auto damping = product(with_damping, By::speed, d);
    EXPECT_LT(distance(damping, by_speed), 1e-6 * norm_of(damping));
  });
}

TEST(InternalForces, HaveSymmetricJacobians) {
  for_all([](const NamedMesh& m, const InternalForce& f, const State& s, Random& random) {
    for (const bool definite : {false, true}) {
      ForceJacobian j(s.x.size(), definite);
      f.make(m.mesh, 7, 3).jacobian(s, j);
      const auto a = random_direction(s.x.size(), random), b = random_direction(s.x.size(), random);
      for (const By by : {By::place, By::speed}) {
        const auto ja = product(j, by, a), jb = product(j, by, b);
        EXPECT_NEAR(dot(ja, b), dot(jb, a), 1e-12 * norm_of(ja) * norm_of(b));
      }
    }
  });
}

TEST(InternalForces, ActOnFreeParticlesTheSameWhetherOthersArePinned) {
  for_all([](const NamedMesh& m, const InternalForce& f, const State& s, Random& random) {
    const Force force = f.make(m.mesh, 3, 0.5);
    std::vector<std::uint8_t> pinned(s.x.size(), 0);
    for (std::size_t p = 0; p < pinned.size(); ++p) pinned[p] = p % 4 != 0;
    ParticleState held = s;
    held.pinned = pinned;
    // Pinned particles do not move: neither here nor in the direction of the derivative.
    std::vector<Vec3> way = random_direction(s.x.size(), random);
    for (std::size_t p = 0; p < pinned.size(); ++p)
      if (pinned[p] != 0) way[p].setZero();
    ForceJacobian all(s.x.size(), false), some(s.x.size(), false);
    force.jacobian(s, all);
    force.jacobian(held, some);
    const auto a = force_at(force, s), b = force_at(force, held);
    const auto ja = product(all, By::place, way), jb = product(some, By::place, way);
    for (std::size_t p = 0; p < pinned.size(); ++p) {
      if (pinned[p] != 0) continue;
      EXPECT_EQ(a[p], b[p]);
      EXPECT_LT((ja[p] - jb[p]).norm(), 1e-12 * (1 + ja[p].norm()));  // added in another order
    }
  });
}

TEST(InternalForces, AreDefiniteWhenAskedTo) {
  for_all([](const NamedMesh& m, const InternalForce& f, const State& s, Random& random) {
    ForceJacobian j(s.x.size(), true);
    f.make(m.mesh, 7, 3).jacobian(s, j);
    for (int n = 0; n < 20; ++n) {
      const auto d = random_direction(s.x.size(), random);
      for (const By by : {By::place, By::speed}) {
        const auto jd = product(j, by, d);
        EXPECT_LE(dot(jd, d), 1e-12 * norm_of(jd) * norm_of(d));
      }
    }
  });
}

TEST(InternalForces, NeitherPushNorTurnTheWhole) {
  for_all([](const NamedMesh& m, const InternalForce& f, const State& s, Random&) {
    const auto forces = force_at(f.make(m.mesh, 7, 3), s);
    Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
    double size = 0, arm = 0;
    for (std::size_t p = 0; p < forces.size(); ++p) {
      sum += forces[p];
      torque += s.x[p].cross(forces[p]);
      size += forces[p].norm();
      arm += s.x[p].norm() * forces[p].norm();
    }
    EXPECT_LT(sum.norm(), 1e-11 * size);
    EXPECT_LT(torque.norm(), 1e-11 * arm);
  });
}

TEST(InternalForces, TurnAndMoveWithTheMesh) {
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  for_all([&](const NamedMesh& m, const InternalForce& f, const State& s, Random&) {
    const Force force = f.make(m.mesh, 7, 3);
    State turned = s;
    for (Vec3& p : turned.x) p = turn * p + Vec3(3, -4, 5);
    for (Vec3& v : turned.v) v = turn * v;
    auto expected = force_at(force, s);
    for (Vec3& v : expected) v = turn * v;
    EXPECT_LT(distance(force_at(force, turned), expected), 1e-9 * norm_of(expected));
  });
}

TEST(InternalForces, BrakeAndNeverDrive) {
  for_all([](const NamedMesh& m, const InternalForce& f, const State& s, Random&) {
    const auto damping = plus(force_at(f.make(m.mesh, 7, 3), s), -1, force_at(f.make(m.mesh, 7, 0), s));
    EXPECT_GT(norm_of(damping), 0);
    EXPECT_LT(dot(damping, s.v), 0);
  });
}

TEST(InternalForces, RestInTheShapeTheyStartFrom) {
  for (const NamedMesh& m : closed_meshes()) {
    const State s{m.mesh.vertices, std::vector<Vec3>(m.mesh.vertices.size(), Vec3::Zero())};
    for (const Force& force : {stretch_force(m.mesh, {}), shear_force(m.mesh, {}), bend_force(m.mesh, {}),
                               spring_force(springs_of(m.mesh), {})}) {
      SCOPED_TRACE(force.name + " on " + m.name);
      for (const Vec3& f : force_at(force, s)) EXPECT_LT(f.norm(), 1e-9);
    }
  }
}

TEST(InternalForces, StayFiniteOnDegenerateTriangles) {
  // At rest and in motion: a doubled vertex, three in a line, everything in one point.
  const TriMesh good = mesh::icosphere(1);
  TriMesh doubled = good, line = good, point = good;
  doubled.vertices[1] = doubled.vertices[0];
  for (Vec3& p : line.vertices) p = Vec3(p[0], 0, 0);
  for (Vec3& p : point.vertices) p = Vec3(1, 2, 3);
  const std::vector<Vec3> still(good.vertices.size(), Vec3(0.1, 0, 0));
  for (const TriMesh& rest : {good, doubled, line, point})
    for (const InternalForce& f : internal_forces()) {
      const Force force = f.make(rest, 7, 3);
      for (const TriMesh& now : {good, doubled, line, point}) {
        const State s{now.vertices, still};
        for (const Vec3& v : force_at(force, s)) ASSERT_TRUE(v.allFinite()) << f.name;
        for (const bool definite : {false, true}) {
          ForceJacobian j(still.size(), definite);
          force.jacobian(s, j);
          for (const auto& row : j.rows())
            for (std::size_t k = 0; k < row.columns.size(); ++k)
              ASSERT_TRUE(row.dfdx[k].allFinite() && row.dfdv[k].allFinite()) << f.name;
        }
        ASSERT_TRUE(std::isfinite(force.energy(s)));
      }
    }
}

// --- known answers

State still(std::vector<Vec3> x) {
  const std::size_t n = x.size();
  return {std::move(x), std::vector<Vec3>(n, Vec3::Zero())};
}

TEST(Stretch, StoresTheSquareOfTheStrain) {
  const TriMesh m{{{0, 0, 0}, {2, 0, 0}, {0, 3, 0}}, {{0, 1, 2}}};  // area 3
  const Force force = stretch_force(m, {.stiffness = 4, .damping = 0, .area_unit_mm2 = 1});
  EXPECT_NEAR(force.energy(still({{0, 0, 0}, {2.2, 0, 0}, {0, 2.7, 0}})), 4 / 2.0 * 9 * (0.01 + 0.01), 1e-12);
  // Pulled along u only: f = k a p (a strain) = 4 * 3 * 1/2 * 3 * 0.1 at the right end.
  const auto f = force_at(force, still({{0, 0, 0}, {2.2, 0, 0}, {0, 3, 0}}));
  EXPECT_LT((f[1] - Vec3(-1.8, 0, 0)).norm(), 1e-12);
  EXPECT_LT((f[0] - Vec3(1.8, 0, 0)).norm(), 1e-12);
  // In units of the mean triangle, its own area is 1.
  EXPECT_NEAR(stretch_force(m, {.stiffness = 4, .damping = 0}).energy(still({{0, 0, 0}, {2.2, 0, 0}, {0, 3, 0}})),
              4 / 2.0 * 0.01, 1e-12);
}

TEST(Shear, FeelsTheAngleAndNotTheLength) {
  const TriMesh m{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};  // area 1/2
  const Force force = shear_force(m, {.stiffness = 4, .damping = 0, .area_unit_mm2 = 1});
  EXPECT_NEAR(force.energy(still({{0, 0, 0}, {1, 0, 0}, {0.3, 1, 0}})), 4 / 2.0 * 0.25 * 0.09, 1e-12);
  EXPECT_NEAR(force.energy(still({{0, 0, 0}, {5, 0, 0}, {0, 0.2, 0}})), 0, 1e-12);
}

TEST(Bend, MeasuresTheAngleBetweenNormals) {
  // The cube has 12 edges of 90 degrees, convex, and 6 flat diagonals.
  const TriMesh m = cube();
  const double right = std::numbers::pi / 2;
  const auto energy = [&](const BendForce& o) { return bend_force(m, o).energy(still(m.vertices)); };
  EXPECT_NEAR(energy({.stiffness = 2, .rest = BendRest::flat}), 12 * right * right, 1e-12);
  EXPECT_NEAR(energy({.stiffness = 2, .rest = BendRest::initial}), 0, 1e-12);
  EXPECT_NEAR(energy({.stiffness = 2, .rest = BendRest::zone, .zone_low_rad = 0, .zone_high_rad = 1.6}), 0, 1e-12);
  EXPECT_NEAR(energy({.stiffness = 2, .rest = BendRest::zone, .zone_low_rad = -1.6, .zone_high_rad = 1}),
              12 * (right - 1) * (right - 1), 1e-12);
  EXPECT_NEAR(energy({.stiffness = 2, .rest = BendRest::zone, .zone_low_rad = 2, .zone_high_rad = 2.5}),
              12 * (right - 2) * (right - 2) + 6 * 2 * 2, 1e-12);
}

TEST(Bend, FlattensAFold) {
  // Two triangles about the y axis, folded upwards: the tips are pushed down, the edge up.
  const TriMesh m{{{1, 0, 0.3}, {-1, 0, 0.3}, {0, -1, 0}, {0, 1, 0}}, {{0, 3, 2}, {1, 2, 3}}};
  const auto f = force_at(bend_force(m, {.rest = BendRest::flat}), still(m.vertices));
  EXPECT_LT(f[0][2], 0);
  EXPECT_LT(f[1][2], 0);
  EXPECT_GT(f[2][2], 0);
  EXPECT_GT(f[3][2], 0);
}

TEST(Bend, LeavesOpenEdgesAlone) {
  const TriMesh one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(bend_force(one, {.rest = BendRest::flat}).energy(still({{0, 0, 0}, {1, 0, 5}, {0, 1, -3}})), 0);
}

TEST(Springs, AreTheEdgesOfTheMeshOnce) {
  const auto springs = springs_of(mesh::icosphere(2), 0.5);
  EXPECT_EQ(springs.size(), 480U);
  const TriMesh m = mesh::icosphere(2);
  for (const Spring& s : springs) EXPECT_DOUBLE_EQ(s.rest_mm, 0.5 * (m.vertices[s.a] - m.vertices[s.b]).norm());
}

TEST(Springs, PullTogetherWhatIsTooLongAndBrake) {
  const Force force = spring_force({{0, 1, 2}}, {.stiffness = 10, .damping = 3});
  State s = still({{0, 0, 0}, {2.5, 0, 0}});
  EXPECT_EQ(force_at(force, s), (std::vector<Vec3>{{5, 0, 0}, {-5, 0, 0}}));
  s.v[1] = {1, 7, 0};  // moves away; sideways motion is free
  EXPECT_EQ(force_at(force, s), (std::vector<Vec3>{{8, 0, 0}, {-8, 0, 0}}));
  EXPECT_EQ(force_at(force, still({{1, 1, 1}, {1, 1, 1}})), (std::vector<Vec3>(2, Vec3::Zero())));
}

TEST(Springs, SwingWithThePeriodOfTwoMasses) {
  ParticleSystem system = particles_at(std::vector<Vec3>{{0, 0, 0}, {2.2, 0, 0}}, 3);  // 1.5 kg each
  system.forces.push_back(spring_force({{0, 1, 2}}, {.stiffness = 40, .damping = 0}));
  ParticleSolver solver(Rk4{});
  const double period = 2 * std::numbers::pi * std::sqrt(1.5 / (2 * 40));
  for (int n = 0; n < 1000; ++n) solver.step(system, period / 1000);
  EXPECT_NEAR(system.positions[1][0] - system.positions[0][0], 2.2, 1e-9);
  for (int n = 0; n < 500; ++n) solver.step(system, period / 1000);
  EXPECT_NEAR(system.positions[1][0] - system.positions[0][0], 1.8, 1e-9);
}

TEST(Springs, KeepMomentumAndLoseEnergy) {
  Random random;
  const TriMesh m = mesh::icosphere(2);
  const State s = shaken(m, random);
  ParticleSystem system = particles_at(s.x, 1);
  system.velocities = s.v;
  system.forces.push_back(spring_force(springs_of(m), {.stiffness = 5, .damping = 0.01}));
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t p = 0; p < system.size(); ++p) sum += system.masses[p] * system.velocities[p];
    return sum;
  };
  const Vec3 before = momentum();
  ParticleSolver solver(Rk4{});
  double energy = kinetic_energy(system) + potential_energy(system);
  for (int n = 0; n < 300; ++n) {
    solver.step(system, 1e-3);
    const double now = kinetic_energy(system) + potential_energy(system);
    ASSERT_LT(now, energy);
    energy = now;
  }
  EXPECT_LT((momentum() - before).norm(), 1e-12);
}

TEST(RestrictedSprings, LeaveTheDirectionOfTheFieldToTheField) {
  Grid g;
  g.dims = {8, 8, 8};
  field::VectorField field(g);
  std::fill(field.z.begin(), field.z.end(), 0.2F);
  // In the plane i = 6 the field is weaker than the threshold: springs are free there.
  for (int k = 0; k < 8; ++k)
    for (int j = 0; j < 8; ++j) field.z[g.index(6, j, k)] = 1e-4F;
  const Force plain = spring_force({{0, 1, 1}}, {.stiffness = 10, .damping = 0});
  const Force restricted = restricted_spring_force({{0, 1, 1}}, field, {.stiffness = 10, .damping = 0});
  const State s = still({{2, 2, 2}, {6, 2, 5}});
  const auto free = force_at(plain, s), held = force_at(restricted, s);
  EXPECT_NE(free[0][2], 0);
  EXPECT_LT((held[0] - Vec3(free[0][0], free[0][1], 0)).norm(), 1e-12);
  EXPECT_EQ(held[1], free[1]);
  ForceJacobian j(2, true);
  restricted.jacobian(s, j);
  // Rows hold their own block first, then the partner's.
  EXPECT_LT((j.rows()[0].dfdx[1] - j.rows()[1].dfdx[1].transpose()).norm(), 1e-12);
  EXPECT_EQ(j.rows()[0].dfdx[0].row(2).norm(), 0);
}

TEST(OuterForces, AreWhatTheySay) {
  Grid g;
  g.dims = {4, 4, 4};
  g.spacing = {2, 2, 2};
  Image drag(g, 0.5F);
  drag(3, 0, 0) = 7;
  field::VectorField field(g);
  std::fill(field.y.begin(), field.y.end(), 0.25F);
  const State s{{{0, 0, 0}, {5.1, -3, 0.9}}, {{1, 2, 3}, {1, 0, -1}}};
  EXPECT_EQ(force_at(drag_force(0.5), s), (std::vector<Vec3>{{-0.5, -1, -1.5}, {-0.5, 0, 0.5}}));
  EXPECT_EQ(force_at(drag_force(drag), s), (std::vector<Vec3>{{-0.5, -1, -1.5}, {-7, 0, 7}}));
  EXPECT_EQ(force_at(field_pull(field, 8), s), (std::vector<Vec3>{{0, 2, 0}, {0, 2, 0}}));
  EXPECT_EQ(force_at(gravity_force({1, 2}, {0, 0, -10}), s), (std::vector<Vec3>{{0, 0, -10}, {0, 0, -20}}));
  EXPECT_EQ(gravity_force({1, 2}, {0, 0, -10}).energy(s), 18);
  ForceJacobian j(2);
  drag_force(drag).jacobian(s, j);
  EXPECT_EQ(j.rows()[1].dfdv[0], (-7 * Mat3::Identity()).eval());
}

TEST(OuterForces, ReadTheNearestVoxelHoweverFarTheParticle) {
  Grid g;
  g.dims = {2, 2, 2};
  Image drag(g, 1.0F);
  drag(1, 1, 1) = 3;
  const double far = 1e300, nowhere = std::numeric_limits<double>::quiet_NaN();
  const State s{{{far, far, far}, {nowhere, nowhere, nowhere}}, {{1, 1, 1}, {1, 1, 1}}};
  EXPECT_EQ(force_at(drag_force(drag), s), (std::vector<Vec3>{{-3, -3, -3}, {-1, -1, -1}}));
}

}  // namespace
}  // namespace dynasurf::dynamics
