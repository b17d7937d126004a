#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "dynasurf/dynamics/solvers/solver.hpp"

namespace dynasurf {
namespace {

const SolverOptions kSolvers[] = {Euler{}, Midpoint{}, Rk4{}};

std::string_view name_of(const SolverOptions& s) {
  return std::visit([](const auto& method) { return method.name; }, s);
}

std::vector<double> integrate(const SolverOptions& solver, std::vector<double> y, double h, int steps,
                              const Derivative& f) {
  std::vector<double> scratch(kSolverScratch * y.size());
  for (int s = 0; s < steps; ++s) advance(solver, y, h, f, scratch);
  return y;
}

/// x' = v, v' = -w^2 x.
Derivative oscillator(double w) {
  return [w](std::span<const double> y, std::span<double> dydt) {
    dydt[0] = y[1];
    dydt[1] = -w * w * y[0];
  };
}

Derivative decay(double rate) {
  return [rate](std::span<const double> y, std::span<double> dydt) {
    for (std::size_t i = 0; i < y.size(); ++i) dydt[i] = -rate * y[i];
  };
}

TEST(Solvers, HaveTheOrders1And2And4) {
  // A nonlinear problem with a known solution: y' = y^2 cos t with t as a second unknown, y = 1/(1 - sin t).
  const Derivative f = [](std::span<const double> y, std::span<double> dydt) {
    dydt[0] = y[0] * y[0] * std::cos(y[1]);
    dydt[1] = 1;
  };
  const auto error = [&](const SolverOptions& solver, int steps) {
    const double end = 0.8;
    return std::abs(integrate(solver, {1, 0}, end / steps, steps, f)[0] - 1 / (1 - std::sin(end)));
  };
  const double order[] = {1, 2, 4};
  for (int s = 0; s < 3; ++s) {
    const double measured = std::log2(error(kSolvers[s], 200) / error(kSolvers[s], 400));
    EXPECT_NEAR(measured, order[s], 0.05) << name_of(kSolvers[s]);
  }
}

TEST(Solvers, AreExactWhereTheirOrderSaysSo) {
  // Free fall under weight: x is of degree 2 in time, exact for midpoint and RK4; Euler lags by g h t / 2.
  const Derivative fall = [](std::span<const double> y, std::span<double> dydt) {
    dydt[0] = y[1];
    dydt[1] = -9.81;
  };
  const double t = 2, h = 0.1, exact = 3 * t - 9.81 * t * t / 2;
  EXPECT_NEAR(integrate(Euler{}, {0, 3}, h, 20, fall)[0], exact + 9.81 * h * t / 2, 1e-12);
  EXPECT_NEAR(integrate(Midpoint{}, {0, 3}, h, 20, fall)[0], exact, 1e-12);
  EXPECT_NEAR(integrate(Rk4{}, {0, 3}, h, 20, fall)[0], exact, 1e-12);
}

TEST(Euler, SpiralsOutwardsBySqrtOnePlusHwSquaredPerStep) {
  const double w = 3, h = 0.02;
  const auto energy = [&](const std::vector<double>& y) { return std::hypot(w * y[0], y[1]); };
  const double grown = energy(integrate(Euler{}, {1, 0}, h, 250, oscillator(w))) / w;
  EXPECT_NEAR(grown, std::pow(std::sqrt(1 + h * h * w * w), 250), 1e-9);
}

TEST(Euler, OscillatesAboveOneAndDivergesAboveTwoTimesTheTimeConstant) {
  // Erratum E18: between the two it alternates and decays all the same.
  const auto after = [](double hk, int steps) { return integrate(Euler{}, {1}, hk / 5, steps, decay(5))[0]; };
  EXPECT_GT(after(0.9, 1), 0);
  EXPECT_LT(after(1.5, 1), 0);
  EXPECT_LT(std::abs(after(1.5, 60)), 1e-15);
  EXPECT_NEAR(std::abs(after(2, 61)), 1, 1e-12);
  EXPECT_GT(std::abs(after(2.1, 61)), 300);
}

TEST(Rk4, KeepsTheOscillatorNearlyForManyPeriods) {
  const double w = 2 * std::numbers::pi;
  const auto y = integrate(Rk4{}, {1, 0}, 0.01, 2000, oscillator(w));  // 20 periods
  EXPECT_NEAR(y[0], 1, 2e-5);
  EXPECT_NEAR(y[1], 0, 2e-2);
}

/// Largest step at which the drag alone does not blow up, found by trying.
double limit_by_bisection(const SolverOptions& solver, double rate) {
  double good = 0, bad = 10 / rate;
  for (int b = 0; b < 60; ++b) {
    const double h = (good + bad) / 2;
    const double left = std::abs(integrate(solver, {1}, h, 200, decay(rate))[0]);
    (left <= 1 ? good : bad) = h;
  }
  return good;
}

TEST(StepLimit, ReproducesTable42ByBisection) {
  // Mass 1 kg in all, drag 0.1: the printed steps 0.1, 0.031, 0.007 / 0.172, 0.043, 0.01 lie just below.
  const std::size_t particles[] = {162, 642, 2562};
  const double expected[3][3] = {
      {0.1235, 0.0312, 0.0078}, {0.1235, 0.0312, 0.0078}, {0.1719, 0.0434, 0.0109}};  // rounded to 4 digits
  for (int s = 0; s < 3; ++s)
    for (int m = 0; m < 3; ++m) {
      const double found = limit_by_bisection(kSolvers[s], 0.1 * static_cast<double>(particles[m]));
      EXPECT_NEAR(found, expected[s][m], 5.1e-5) << name_of(kSolvers[s]) << " " << particles[m];
      EXPECT_NEAR(found / step_limit_s(kSolvers[s], 1, particles[m], 0.1), 1, 1e-9);
    }
}

TEST(StepLimit, IsInfiniteWithoutDrag) {
  for (const SolverOptions& s : kSolvers)
    EXPECT_EQ(step_limit_s(s, 1, 642, 0), std::numeric_limits<double>::infinity());
}

TEST(Solvers, TreatEveryUnknownByItself) {
  // The same numbers alone or in a batch: what the packing of particles relies on.
  for (const SolverOptions& s : kSolvers) {
    std::vector<double> many(37);
    for (std::size_t i = 0; i < many.size(); ++i) many[i] = 0.1 + 0.3 * static_cast<double>(i);
    const auto together = integrate(s, many, 0.07, 9, decay(2));
    for (std::size_t i = 0; i < many.size(); ++i) EXPECT_EQ(together[i], integrate(s, {many[i]}, 0.07, 9, decay(2))[0]);
  }
}

}  // namespace
}  // namespace dynasurf
