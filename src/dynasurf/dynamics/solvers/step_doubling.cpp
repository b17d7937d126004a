#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/dynamics/solvers/detail/error_control.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"

namespace dynasurf::dynamics {
namespace {

/// Order of the global error.
int order_of(BaseMethod base) { return base == BaseMethod::euler ? 1 : base == BaseMethod::midpoint ? 2 : 4; }

void advance_base(BaseMethod base, std::span<double> y, double h, const Derivative& f, std::span<double> scratch) {
  if (base == BaseMethod::euler) advance(Euler{}, y, h, f, scratch);
  if (base == BaseMethod::midpoint) advance(Midpoint{}, y, h, f, scratch);
  if (base == BaseMethod::rk4) advance(Rk4{}, y, h, f, scratch);
}

}  // namespace

// Thesis 4.25-4.28. The printed exponent 1/2 is Euler's; in general it is 1 / (order + 1).
AdaptiveStep advance_once(const StepDoubling& o, std::span<double> y, double h, std::span<const double> tolerance,
                          const Derivative& f, std::span<double> scratch) {
  const std::size_t n = y.size();
  const std::span<double> whole = scratch.first(n), halves = scratch.subspan(n, n), rest = scratch.subspan(2 * n);
  const int order = order_of(o.base);
  const auto attempt = [&](double step) {
    std::copy(y.begin(), y.end(), whole.begin());
    std::copy(y.begin(), y.end(), halves.begin());
    advance_base(o.base, whole, step, f, rest);
    advance_base(o.base, halves, step / 2, f, rest);
    advance_base(o.base, halves, step / 2, f, rest);
    return error_control::worst(halves, whole, tolerance);
  };
  const double gain = o.extrapolate ? 1 / (own::pow(2, order) - 1) : 0;
  const auto accept = [&] {
    for (std::size_t i = 0; i < n; ++i) y[i] = halves[i] + gain * (halves[i] - whole[i]);
  };
  return error_control::control(h, 1.0 / (order + 1), attempt, accept);
}

void advance(const StepDoubling& o, std::span<double> y, double h, const Derivative& f, std::span<double> scratch) {
  error_control::cover(o, y, h, f, scratch);
}

}  // namespace dynasurf::dynamics
