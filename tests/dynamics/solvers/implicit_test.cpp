#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/dynamics/forces/forces.hpp"
#include "dynasurf/dynamics/solvers/detail/conjugate_gradients.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"

#include "support/shapes.hpp"

namespace dynasurf::dynamics {
namespace {

using namespace test_shapes;

// --- chains (ODE-THETA)

struct Bands {
  std::vector<double> lower, diagonal, upper, right;
  Eigen::MatrixXd dense(bool cyclic) const {
    const auto n = static_cast<Eigen::Index>(right.size());
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      a(i, i) = diagonal[k];
      if (i > 0 || cyclic) a(i, (i + n - 1) % n) += lower[k];
      if (i < n - 1 || cyclic) a(i, (i + 1) % n) += upper[k];
    }
    return a;
  }
};

Bands random_bands(std::size_t n, std::mt19937& random) {
  Bands b;
  for (std::size_t i = 0; i < n; ++i) {
    const auto number = [&] { return random() / 2147483648.0 - 1; };
    b.lower.push_back(number());
    b.upper.push_back(number());
    b.right.push_back(number());
    b.diagonal.push_back(2.5 + 0.4 * number());
  }
  return b;
}

TEST(Chain, IsSolvedAsADenseSystemWouldBe) {
  std::mt19937 random(3);
  for (const bool cyclic : {false, true})
    for (const std::size_t n : {1, 2, 3, 4, 17, 200}) {
      if (cyclic && n < 3) continue;
      const Bands b = random_bands(n, random);
      std::vector<double> x = b.right;
      if (cyclic)
        solve_cyclic(b.lower, b.diagonal, b.upper, x);
      else
        solve_tridiagonal(b.lower, b.diagonal, b.upper, x);
      const auto size = static_cast<Eigen::Index>(n);
      const Eigen::VectorXd assess =
          b.dense(cyclic).partialPivLu().solve(Eigen::Map<const Eigen::VectorXd>(b.right.data(), size));
      EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(x.data(), size) - assess).norm(), 1e-13 * (1 + assess.norm()));
    }
}

/// A wave on a closed chain of n: its amplitude shrinks with the rate k (2 - 2 cos(2 pi m / n)).
std::vector<double> wave(std::size_t n, int m) {
  std::vector<double> y(n);
  for (std::size_t i = 0; i < n; ++i)
    y[i] = std::cos(2 * std::numbers::pi * m * static_cast<double>(i) / static_cast<double>(n));
  return y;
}

TEST(Chain, DampsAWaveAsTheMethodSays) {
  const Chain chain{.stiffness = 3, .closed = true};
  const double rate = 3 * (2 - 2 * std::cos(2 * std::numbers::pi * 2 / 12.0));
  for (const double theta : {0.0, 0.3, 0.5, 1.0})
    for (const double h : {0.01, 0.2, 50.0}) {
      std::vector<double> y = wave(12, 2);
      advance_chain(chain, y, h, theta);
      EXPECT_NEAR(y[0], (1 - (1 - theta) * h * rate) / (1 + theta * h * rate), 1e-12 * (1 + h));
    }
}

TEST(Chain, IsOfSecondOrderAtOneHalfAndOfFirstElsewhere) {
  const double rate = 2 - 2 * std::cos(2 * std::numbers::pi / 10);
  const auto error = [&](double theta, int steps) {
    std::vector<double> y = wave(10, 1);
    for (int s = 0; s < steps; ++s) advance_chain({.closed = true}, y, 2.0 / steps, theta);
    return std::abs(y[0] - std::exp(-2 * rate));
  };
  for (const double theta : {0.0, 0.25, 0.5, 1.0})
    EXPECT_NEAR(std::log2(error(theta, 200) / error(theta, 400)), theta == 0.5 ? 2 : 1, 0.03) << theta;
}

TEST(Chain, BalancesAPullAndStaysStableForHugeSteps) {
  // Open chain: the ends pulled apart with force 2, springs of 4: every link is 1/2 long at rest.
  std::vector<double> y{0, 5, -3, 2, 100}, pull{-2, 0, 0, 0, 2};
  for (int s = 0; s < 20; ++s) advance_chain({.stiffness = 4}, y, 1e6, 1, pull);
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(y[static_cast<std::size_t>(i) + 1] - y[static_cast<std::size_t>(i)], 0.5, 1e-6);
  EXPECT_NEAR((y[0] + y[1] + y[2] + y[3] + y[4]) / 5, 104 / 5.0, 1e-6);  // nothing pulls the whole
}

// --- conjugate gradients

TEST(ConjugateGradients, SolveWhatADenseSolverDoes) {
  std::mt19937 random(9);
  const auto number = [&] { return random() / 2147483648.0 - 1; };
  const Eigen::Index n = 8;
  Eigen::MatrixXd half(3 * n, 3 * n);
  for (Eigen::Index i = 0; i < half.size(); ++i) half(i / (3 * n), i % (3 * n)) = number();
  const Eigen::MatrixXd a = half * half.transpose() + 0.5 * Eigen::MatrixXd::Identity(3 * n, 3 * n);
  std::vector<Vec3> b(n), x(n);
  std::vector<Mat3> inverse(n);
  for (std::size_t i = 0; i < b.size(); ++i) {
    b[i] = Vec3(number(), number(), number());
    const auto at = static_cast<Eigen::Index>(3 * i);
    inverse[i] = a.block<3, 3>(at, at).inverse();
  }
  const auto multiply = [&](std::span<const Vec3> from, std::span<Vec3> to) {
    Eigen::Map<Eigen::VectorXd>(to.data()->data(), 3 * n) =
        a * Eigen::Map<const Eigen::VectorXd>(from.data()->data(), 3 * n);
  };
  const CgResult r = conjugate_gradients(multiply, inverse, b, x, 1e-12, 200);
  EXPECT_TRUE(r.converged);
  EXPECT_LE(r.iterations, 40);
  const Eigen::VectorXd assess = a.llt().solve(Eigen::Map<const Eigen::VectorXd>(b.data()->data(), 3 * n));
  EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(x.data()->data(), 3 * n) - assess).norm(), 1e-9 * assess.norm());
  EXPECT_FALSE(conjugate_gradients(multiply, inverse, b, x, 1e-12, 3).converged);
}

TEST(ConjugateGradients, SeeThatASystemIsNotDefinite) {
  std::vector<Vec3> b{{1, 1, 1}, {1, -1, 0}}, x(2);
  const std::vector<Mat3> inverse(2, Mat3::Identity());
  const auto indefinite = [](std::span<const Vec3> from, std::span<Vec3> to) {
    to[0] = from[0];
    to[1] = -3 * from[1];
  };
  EXPECT_FALSE(conjugate_gradients(indefinite, inverse, b, x, 1e-9, 100).is_definite);
}

// --- backward Euler (ODE-BEULER)

ParticleSystem shaken_sphere(int level, double mass_kg) {
  const TriMesh m = mapped(mesh::icosphere(level), [](const Vec3& p) { return Vec3(20 * p); });
  std::mt19937 random(21);
  const auto number = [&] { return random() / 2147483648.0 - 1; };
  ParticleSystem system = particles_at(m.vertices, mass_kg);
  for (std::size_t p = 0; p < system.size(); ++p) {
    system.positions[p] = 0.9 * system.positions[p] + 0.4 * Vec3(number(), number(), number());
    system.velocities[p] = Vec3(number(), number(), number());
  }
  system.pinned.assign(system.size(), 0);
  system.pinned[3] = 1;
  system.forces = {stretch_force(m, {}), shear_force(m, {}),
                   bend_force(m, {}),    spring_force(springs_of(m), {.stiffness = 3, .damping = 0.2}),
                   drag_force(0.1),      gravity_force(system.masses, {0, 0, -9.81})};
  return system;
}

/// dF/dx and dF/dv, definite.
std::pair<Eigen::MatrixXd, Eigen::MatrixXd> dense_jacobians(const ParticleSystem& system) {
  const auto n = static_cast<Eigen::Index>(system.size());
  ForceJacobian j(system.size(), true);
  for (const Force& f : system.forces)
    if (f.jacobian) f.jacobian(system.state(), j);
  Eigen::MatrixXd kx = Eigen::MatrixXd::Zero(3 * n, 3 * n), kv = kx;
  for (std::size_t r = 0; r < system.size(); ++r)
    for (std::size_t k = 0; k < j.rows()[r].columns.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(3 * r), column = static_cast<Eigen::Index>(3 * j.rows()[r].columns[k]);
      kx.block<3, 3>(row, column) += j.rows()[r].dfdx[k];
      kv.block<3, 3>(row, column) += j.rows()[r].dfdv[k];
    }
  return {kx, kv};
}

TEST(BackwardEulerStep, EqualsADenseSolve) {
  for (const double h : {0.001, 0.05, 1.0}) {
    ParticleSystem system = shaken_sphere(1, 1);
    const auto n = static_cast<Eigen::Index>(system.size());
    system.velocities[3].setZero();  // pinned
    const ParticleSystem before = system;
    std::vector<Vec3> force(system.size());
    total_force(system.forces, system.state(), force);
    const auto [kx, kv] = dense_jacobians(system);
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    for (Eigen::Index r = 0; r < 3 * n; ++r) mass(r, r) = system.masses[static_cast<std::size_t>(r / 3)];
    const Eigen::Map<const Eigen::VectorXd> v(before.velocities.data()->data(), 3 * n);
    const Eigen::Map<const Eigen::VectorXd> f(force.data()->data(), 3 * n);
    Eigen::MatrixXd a = mass - h * kv - h * h * kx;
    Eigen::VectorXd b = h * (f + h * kx * v);
    a.middleRows(9, 3).setZero();
    a.middleCols(9, 3).setZero();
    a.block<3, 3>(9, 9).setIdentity();
    b.segment<3>(9).setZero();
    const Eigen::VectorXd dv = a.llt().solve(b);

    const SolverWork report = ParticleSolver(BackwardEuler{.tolerance = 1e-12}).step(system, h);
    EXPECT_TRUE(report.converged);
    double worst = 0;
    for (std::size_t p = 0; p < system.size(); ++p) {
      const Vec3 expected = before.velocities[p] + dv.segment<3>(static_cast<Eigen::Index>(3 * p));
      worst = std::max(worst, (system.velocities[p] - expected).norm());
      EXPECT_LT((system.positions[p] - before.positions[p] - h * system.velocities[p]).norm(), 1e-12);
    }
    EXPECT_LT(worst, 1e-8 * dv.norm());
    EXPECT_EQ(system.positions[3], before.positions[3]);
  }
}

TEST(BackwardEulerStep, DampsAnOscillatorBySqrtOnePlusHwSquared) {
  // A spring along x to a pinned particle; w^2 = k/m = 50. At any step: decay, no blow-up.
  for (const double hw : {0.01, 1.0, 30.0}) {
    ParticleSystem system = particles_at(std::vector<Vec3>{{-10, 0, 0}, {1, 0, 0}}, 4);
    system.pinned = {1, 0};
    system.forces = {spring_force({{0, 1, 10}}, {.stiffness = 100, .damping = 0})};
    const double w = std::sqrt(50.0), h = hw / w;
    ParticleSolver solver(BackwardEuler{.tolerance = 1e-13});
    double size = 1;  // of (x, v / w)
    for (int s = 0; s < 3; ++s) {
      solver.step(system, h);
      const double now = std::hypot(system.positions[1][0], system.velocities[1][0] / w);
      EXPECT_NEAR(now / size, 1 / std::sqrt(1 + hw * hw), 1e-8) << hw;
      size = now;
    }
  }
}

TEST(BackwardEulerStep, ApproachesRk4AsTheStepShrinks) {
  const auto end = [](const SolverOptions& solver, int steps) {
    ParticleSystem system = shaken_sphere(1, 20);
    ParticleSolver stepper(solver);
    for (int s = 0; s < steps; ++s) stepper.step(system, 0.2 / steps);
    return system.positions;
  };
  const auto assess = end(Rk4{}, 2000);
  const auto error = [&](int steps) {
    const auto found = end(BackwardEuler{.stiffness = Stiffening::exact}, steps);
    double worst = 0;
    for (std::size_t p = 0; p < assess.size(); ++p) worst = std::max(worst, (found[p] - assess[p]).norm());
    return worst;
  };
  EXPECT_NEAR(std::log2(error(400) / error(800)), 1, 0.15);
  EXPECT_LT(error(800), 0.01);
}

TEST(BackwardEulerStep, FallsBackToADefiniteSystem) {
  // A spring pressed to half its length, turning, and a long step: exact derivatives are not definite.
  ParticleSystem system = particles_at(std::vector<Vec3>{{0, 0, 0}, {5, 0, 0}}, 1);
  system.velocities[1] = {0, 1, 0};
  system.forces = {spring_force({{0, 1, 10}}, {.stiffness = 100, .damping = 0})};
  const SolverWork report = ParticleSolver(BackwardEuler{.stiffness = Stiffening::exact}).step(system, 1);
  EXPECT_TRUE(report.made_definite);
  EXPECT_TRUE(report.converged);
  EXPECT_TRUE(system.positions[1].allFinite());
  ParticleSystem calm = particles_at(std::vector<Vec3>{{0, 0, 0}, {12, 0, 0}}, 1);
  calm.forces = system.forces;
  EXPECT_FALSE(ParticleSolver(BackwardEuler{.stiffness = Stiffening::exact}).step(calm, 1).made_definite);
}

TEST(ParticleSolver, GivesTheSameBytesForAnyNumberOfThreads) {
  for (const SolverOptions& solver : {SolverOptions(BackwardEuler{}), SolverOptions(Rk4{}), SolverOptions(Rkf45{})}) {
    std::vector<Vec3> first;
    for (const int threads : {1, 2, 4}) {
      const ThreadLimit limit(threads);
      ParticleSystem system = shaken_sphere(4, 30);
      ParticleSolver stepper(solver);
      for (int s = 0; s < 3; ++s) stepper.step(system, 0.002);
      if (first.empty()) first = system.positions;
      EXPECT_EQ(std::memcmp(first.data(), system.positions.data(), first.size() * sizeof(Vec3)), 0);
    }
  }
}

TEST(ParticleSolver, HoldsPinnedParticlesWithEverySolver) {
  for (const SolverOptions& solver :
       {SolverOptions(Euler{}), SolverOptions(Midpoint{}), SolverOptions(Rk4{}), SolverOptions(StepDoubling{}),
        SolverOptions(Rkf45{}), SolverOptions(BackwardEuler{})}) {
    ParticleSystem system = shaken_sphere(1, 20);
    const Vec3 before = system.positions[3];
    ParticleSolver stepper(solver);
    for (int s = 0; s < 5; ++s) stepper.step(system, 0.002);
    EXPECT_EQ(system.positions[3], before);
    EXPECT_EQ(system.velocities[3], Vec3(0, 0, 0));
    EXPECT_NE(system.velocities[4], Vec3(0, 0, 0));
  }
}

TEST(FastestModes, AreThoseOfADenseEigensolver) {
  ParticleSystem system = shaken_sphere(1, 2);
  system.pinned.clear();
  const auto [kx, kv] = dense_jacobians(system);
  const double mass = system.masses[0];
  const Fastest found = fastest_modes(system);
  // Power iteration comes from below; a few per cent are enough for a step that keeps a fifth in hand.
  const double stiffest = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(-kx / mass).eigenvalues().maxCoeff();
  const double dampest = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(-kv / mass).eigenvalues().maxCoeff();
  EXPECT_NEAR(found.stiffness / stiffest, 0.97, 0.0301);
  EXPECT_NEAR(found.damping / dampest, 0.97, 0.0301);
}

TEST(FastestModes, AreFoundAgainFromAFormerSearchWhenTheSystemHasMoved) {
  ParticleSystem system = shaken_sphere(2, 2);
  ModeSearch search;
  fastest_modes(system, &search);
  ParticleSolver solver(Rk4{});
  for (int s = 0; s < 16; ++s) solver.step(system, 0.002);
  const Fastest anew = fastest_modes(system), again = fastest_modes(system, &search);
  // Both come from below, each as near as its iterations bring it.
  EXPECT_NEAR(again.stiffness / anew.stiffness, 1, 0.02);
  EXPECT_NEAR(again.damping / anew.damping, 1, 0.02);
  // A search that began with another system's modes finds the stiffer ones, too.
  for (Force& f : system.forces) f.jacobian = nullptr;
  system.forces.push_back(spring_force({{0, 1, 1.0}}, {.stiffness = 1e6, .damping = 1e3}));
  for (int s = 0; s < 3; ++s) fastest_modes(system, &search);
  // A spring is nearly as stiff sideways, which is slow to tell apart; the step keeps a fifth in hand.
  EXPECT_NEAR(fastest_modes(system, &search).stiffness / fastest_modes(system).stiffness, 1, 0.05);
}

}  // namespace
}  // namespace dynasurf::dynamics
