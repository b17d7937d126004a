#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "dynasurf/dynamics/solvers/solver.hpp"

namespace dynasurf::dynamics {
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

// --- error control (ODE-ADAPT, FUT-ADAPTRK)

const StepDoubling kDoublings[] = {
    {.base = BaseMethod::euler}, {.base = BaseMethod::midpoint}, {.base = BaseMethod::rk4}};

/// Advances by accepted steps to `end`; returns the unknowns and how many steps it took.
template <class Method>
std::pair<std::vector<double>, int> cover(const Method& method, std::vector<double> y, double end, double h,
                                          const std::vector<double>& tolerance, const Derivative& f) {
  std::vector<double> scratch(kSolverScratch * y.size());
  int steps = 0;
  for (double t = 0; t < end; ++steps) {
    const AdaptiveStep step = advance_once(method, y, std::min(h, end - t), tolerance, f, scratch);
    EXPECT_LE(step.error, 1);
    t += step.taken;
    h = step.next;
    if (end - t < 1e-12 * end) break;
  }
  return {y, steps};
}

TEST(StepDoubling, ChangesTheStepByTheRootOfTheError) {
  // Thesis 4.27: with Euler, a desired error of 1e-3 and one of 1e-6 the step could be 31.6 times longer, with 1e-2 it
  // must be 0.316 times as long. y' = 1 + 2a t, with t as second unknown: the two answers differ by a h^2 / 2.
  const auto attempt = [](double error) {
    const double a = 2 * error;  // h = 1
    const Derivative f = [a](std::span<const double> y, std::span<double> dydt) {
      dydt[0] = 2 * a * y[1];
      dydt[1] = 1;
    };
    std::vector<double> y{0, 0}, scratch(2 * kSolverScratch);
    const double tolerance = 1e-3;
    return advance_once(StepDoubling{.base = BaseMethod::euler}, y, 1, std::span(&tolerance, 1), f, scratch);
  };
  const AdaptiveStep small = attempt(1e-6);
  EXPECT_NEAR(small.error, 1e-3, 1e-9);
  EXPECT_EQ(small.rejected, 0);
  EXPECT_EQ(small.next, 5);  // 0.9 * 31.6, held at 5
  const AdaptiveStep fair = attempt(0.5e-3);
  EXPECT_NEAR(fair.next, 0.9 * std::sqrt(2.0), 1e-9);
  const AdaptiveStep large = attempt(1e-2);
  EXPECT_EQ(large.rejected, 1);
  EXPECT_NEAR(large.taken, 0.9 * 0.316228, 1e-6);
}

TEST(StepDoubling, KeepsItsErrorNearTheDesiredOne) {
  // On an oscillator, the error at the end follows the tolerance over four decades: the tighter by 100, the smaller by
  // 10 at least. The number of steps grows by the power of the order.
  for (const StepDoubling& method : kDoublings) {
    double former = 0;
    for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
      const auto [y, steps] = cover(method, {1, 0}, 2.5, 0.1, {tolerance, tolerance}, oscillator(3));
      const double error = std::hypot(y[0] - std::cos(7.5), (y[1] + 3 * std::sin(7.5)) / 3);
      EXPECT_LT(error, 3 * tolerance * steps) << word_of(method.base);
      if (former > 0) {
        EXPECT_LT(error, former / 7) << word_of(method.base);
      }
      former = error;
    }
  }
}

TEST(StepDoubling, GainsAnOrderByExtrapolation) {
  for (StepDoubling method : kDoublings) {
    const double order[] = {1, 2, 4};
    for (const bool extrapolate : {false, true}) {
      method.extrapolate = extrapolate;
      const auto error = [&](int steps) {
        std::vector<double> y{1, 0}, scratch(2 * kSolverScratch);
        const double any = 1e9;
        for (int s = 0; s < steps; ++s)
          advance_once(method, y, 1.0 / steps, std::span(&any, 1), oscillator(2), scratch);
        return std::hypot(y[0] - std::cos(2.0), (y[1] + 2 * std::sin(2.0)) / 2);
      };
      const double expected = order[static_cast<std::size_t>(method.base)] + (extrapolate ? 1 : 0);
      EXPECT_NEAR(std::log2(error(20) / error(40)), expected, 0.25) << word_of(method.base) << extrapolate;
    }
  }
}

TEST(StepDoubling, ObeysTheStrictestUnknown) {
  // Two oscillators; the tolerance of the fast one decides, and only while it is strict.
  const Derivative two = [](std::span<const double> y, std::span<double> dydt) {
    oscillator(1)(y.first(2), dydt.first(2));
    oscillator(20)(y.subspan(2), dydt.subspan(2));
  };
  const std::vector<double> start{1, 0, 1, 0};
  const int strict = cover(StepDoubling{}, start, 3, 0.1, {1e-6, 1e-6, 1e-6, 1e-6}, two).second;
  const int loose = cover(StepDoubling{}, start, 3, 0.1, {1e-6, 1e-6, 1e3, 1e3}, two).second;
  EXPECT_GT(strict, 3 * loose);
}

TEST(Rkf45, HasOrderFiveAndControlsItsError) {
  const auto error = [&](int steps) {
    std::vector<double> y{1, 0}, scratch(2 * kSolverScratch);
    const double any = 1e9;
    for (int s = 0; s < steps; ++s) advance_once(Rkf45{}, y, 2.0 / steps, std::span(&any, 1), oscillator(2), scratch);
    return std::hypot(y[0] - std::cos(4.0), (y[1] + 2 * std::sin(4.0)) / 2);
  };
  EXPECT_NEAR(std::log2(error(20) / error(40)), 5, 0.3);
  for (const double tolerance : {1e-4, 1e-7, 1e-10}) {
    const auto [y, steps] = cover(Rkf45{}, {1, 0}, 2.5, 0.1, {tolerance}, oscillator(3));
    EXPECT_LT(std::abs(y[0] - std::cos(7.5)), tolerance * steps);
  }
}

TEST(Rkf45, NeedsFewerSlopesThanStepDoubling) {
  int calls = 0;
  const Derivative counted = [&](std::span<const double> y, std::span<double> dydt) {
    ++calls;
    oscillator(3)(y, dydt);
  };
  const auto slopes = [&](const auto& method) {
    calls = 0;
    cover(method, {1, 0}, 10, 0.1, {1e-7}, counted);
    return calls;
  };
  EXPECT_LT(slopes(Rkf45{}), slopes(StepDoubling{}));
}

TEST(ErrorControl, CoversTheWholeStepItIsAskedFor) {
  // Through `advance`, however short the inner steps: free fall against a wall of springs.
  const Derivative bounce = [](std::span<const double> y, std::span<double> dydt) {
    dydt[0] = y[1];
    dydt[1] = -10 + (y[0] < 0 ? -1e5 * y[0] : 0);
    dydt[2] = 1;  // time
  };
  for (const SolverOptions& solver : {SolverOptions(StepDoubling{.tolerance = 1e-6}), SolverOptions(Rkf45{1e-6})}) {
    const auto y = integrate(solver, {1, 0, 0}, 0.5, 4, bounce);
    EXPECT_NEAR(y[2], 2, 1e-12);
    EXPECT_NEAR(y[1] * y[1] / 2 + 10 * y[0] + (y[0] < 0 ? 5e4 * y[0] * y[0] : 0), 10, 1e-2);  // energy
  }
}

TEST(ErrorControl, CountsErrorsInTheUnitsItIsGiven) {
  // A fast oscillator beside a slow one: in units in which its errors are small, it costs no more steps.
  const Derivative two = [](std::span<const double> y, std::span<double> dydt) {
    oscillator(1)(y.first(2), dydt.first(2));
    oscillator(20)(y.subspan(2), dydt.subspan(2));
  };
  for (const SolverOptions& solver : {SolverOptions(StepDoubling{.tolerance = 1e-6}), SolverOptions(Rkf45{1e-6})}) {
    const auto steps = [&](const std::vector<double>& units, int most) {
      std::vector<double> y{1, 0, 1, 0}, scratch(4 * kSolverScratch);
      return advance(solver, y, 2, two, scratch, units, most);
    };
    const int strict = steps({}, 1'000'000);
    EXPECT_EQ(steps({1, 1, 1, 1}, 1'000'000), strict);
    EXPECT_GT(strict, 2 * steps({1, 1, 1e4, 1e4}, 1'000'000)) << name_of(solver);
    EXPECT_GE(steps({}, 5), 5);
    EXPECT_LT(steps({}, 5), 5 + 20) << "stops short of the end after 5, and what the last one tried in vain";
  }
}

TEST(Solvers, RefuseWhatNeedsAModelOrAParticleSystem) {
  std::vector<double> y{1}, scratch(kSolverScratch);
  for (const SolverOptions& solver : {SolverOptions(BackwardEuler{}), SolverOptions(AutomaticSolver{})})
    EXPECT_THROW(advance(solver, y, 0.1, decay(1), scratch), OptionError);
}

TEST(ErrorControl, EndsWhereTheRightSideIsNotFinite) {
  const Derivative broken = [](std::span<const double> y, std::span<double> dydt) { dydt[0] = std::sqrt(-1 - y[0]); };
  for (const SolverOptions& solver : {SolverOptions(StepDoubling{}), SolverOptions(Rkf45{})})
    EXPECT_FALSE(std::isfinite(integrate(solver, {1}, 0.5, 1, broken)[0]));
}

// --- limits of the step

TEST(OscillatorLimit, IsWhereAStepBeginsToGrow) {
  // Against trying: 5 % below the limit the oscillator shrinks, 5 % above it grows.
  const auto growth = [](const SolverOptions& solver, double k, double c, double h) {
    const Derivative f = [k, c](std::span<const double> y, std::span<double> dydt) {
      dydt[0] = y[1];
      dydt[1] = -k * y[0] - c * y[1];
    };
    const auto early = integrate(solver, {1, 0.3}, h, 500, f), late = integrate(solver, early, h, 500, f);
    const auto size = [k](const std::vector<double>& y) { return std::hypot(std::sqrt(k) * y[0], y[1]); };
    return size(late) / size(early);
  };
  for (const SolverOptions& solver : kSolvers)
    for (const auto& [k, c] : {std::pair{4.0, 0.5}, {4.0, 4.0}, {4.0, 20.0}}) {
      const double limit = oscillator_limit_s(solver, k, c);
      EXPECT_LT(growth(solver, k, c, 0.95 * limit), 1) << name_of(solver) << " " << k << " " << c;
      EXPECT_GT(growth(solver, k, c, 1.05 * limit), 1) << name_of(solver) << " " << k << " " << c;
    }
  for (const SolverOptions& solver : kSolvers)  // drag alone
    EXPECT_NEAR(oscillator_limit_s(solver, 0, 3) * 3, stability_interval(solver), 1e-9);
}

TEST(OscillatorLimit, IsZeroForEulerWithoutDampingAndAboutTheRootOf8ForRk4) {
  EXPECT_EQ(oscillator_limit_s(Euler{}, 4, 0), 0);
  EXPECT_NEAR(oscillator_limit_s(Rk4{}, 4, 0), std::sqrt(8.0) / 2, 1e-3);
  EXPECT_EQ(oscillator_limit_s(Rk4{}, 0, 0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(oscillator_limit_s(BackwardEuler{}, 4, 1), std::numeric_limits<double>::infinity());
  EXPECT_EQ(oscillator_limit_s(Rkf45{}, 4, 1), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace dynasurf::dynamics
