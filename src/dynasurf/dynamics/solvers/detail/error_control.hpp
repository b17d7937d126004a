#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/dynamics/solvers/detail/adaptive_step.hpp"

// What the solvers that control their error share.
namespace dynasurf::dynamics::error_control {

inline constexpr double kSafety = 0.9, kShrink = 0.1, kGrow = 5, kErrorFloor = 1e-12, kShortest = 1e-12;

/// Largest difference of two solutions, in tolerances. Infinite when one of them is not finite.
inline double worst(std::span<const double> a, std::span<const double> b, std::span<const double> tolerance) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double error = std::abs(a[i] - b[i]) / tolerance[tolerance.size() == 1 ? 0 : i];
    if (!(error <= worst)) worst = std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
  }
  return worst;
}

/// Calls `attempt(h)`, which returns the error of a step of h in tolerances and keeps its result, until the error is at
/// most 1; then `accept()`. `power` is 1 / (order of the error's estimate).
template <class Attempt, class Accept>
AdaptiveStep control(double h, double power, Attempt attempt, Accept accept) {
  AdaptiveStep step;
  const double shortest = kShortest * h;
  for (;;) {
    step.error = attempt(h);
    const double factor = kSafety * own::pow(std::max(step.error, kErrorFloor), -power);
    if (step.error <= 1 || h <= shortest) {
      accept();
      step.taken = h;
      step.next = h * std::clamp(factor, kShrink, kGrow);
      return step;
    }
    ++step.rejected;
    h *= std::max(kShrink, factor);
  }
}

/// Covers `h` by as many accepted steps as it takes, or what `most` attempts reach of it. Returns how many there were.
/// The tolerance counts in `units`, one per unknown; none: in 1.
template <class Method>
int cover(const Method& method, std::span<double> y, double h, const Derivative& f, std::span<double> scratch,
          std::span<const double> units = {}, int most = std::numeric_limits<int>::max()) {
  std::vector<double> tolerance(units.empty() ? 1 : units.size(), method.tolerance);
  for (std::size_t i = 0; i < units.size(); ++i) tolerance[i] *= units[i];
  double left = h, next = h;
  int attempts = 0;
  while (left > 0 && attempts < most) {
    const double asked = std::min(next, left);
    const AdaptiveStep step = advance_once(method, y, asked, tolerance, f, scratch);
    attempts += 1 + step.rejected;
    left = step.taken >= left ? 0 : left - step.taken;
    next = step.taken < asked || asked == next ? step.next : std::max(next, step.next);
    if (!std::all_of(y.begin(), y.end(), [](double v) { return std::isfinite(v); })) break;  // the caller sees it
  }
  return attempts;
}

}  // namespace dynasurf::dynamics::error_control
