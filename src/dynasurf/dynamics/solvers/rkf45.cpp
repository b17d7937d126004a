#include <array>

#include "dynasurf/dynamics/solvers/detail/error_control.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"

namespace dynasurf::dynamics {
namespace {

constexpr std::size_t kStages = 6;
// Fehlberg 1969, table III.
constexpr std::array<std::array<double, kStages - 1>, kStages> kStage{
    {{},
     {1.0 / 4},
     {3.0 / 32, 9.0 / 32},
     {1932.0 / 2197, -7200.0 / 2197, 7296.0 / 2197},
     {439.0 / 216, -8, 3680.0 / 513, -845.0 / 4104},
     {-8.0 / 27, 2, -3544.0 / 2565, 1859.0 / 4104, -11.0 / 40}}};
constexpr std::array<double, kStages> kFourth{25.0 / 216, 0, 1408.0 / 2565, 2197.0 / 4104, -1.0 / 5, 0};
constexpr std::array<double, kStages> kFifth{16.0 / 135, 0, 6656.0 / 12825, 28561.0 / 56430, -9.0 / 50, 2.0 / 55};

}  // namespace

AdaptiveStep advance_once(const Rkf45&, std::span<double> y, double h, std::span<const double> tolerance,
                          const Derivative& f, std::span<double> scratch) {
  const std::size_t n = y.size();
  const auto slope = [&](std::size_t s) { return scratch.subspan(s * n, n); };
  const std::span<double> place = scratch.subspan(kStages * n, n), fourth = scratch.subspan((kStages + 1) * n, n);
  const auto combine = [&](std::span<double> to, const auto& weights, std::size_t count, double step) {
    for (std::size_t i = 0; i < n; ++i) {
      double sum = 0;
      for (std::size_t s = 0; s < count; ++s) sum += weights[s] * scratch[s * n + i];
      to[i] = y[i] + step * sum;
    }
  };
  f(y, slope(0));
  const auto attempt = [&](double step) {
    for (std::size_t s = 1; s < kStages; ++s) {
      combine(place, kStage[s], s, step);
      f(place, slope(s));
    }
    combine(fourth, kFourth, kStages, step);
    combine(place, kFifth, kStages, step);
    return error_control::worst(place, fourth, tolerance);
  };
  return error_control::control(h, 1.0 / 5, attempt, [&] { std::copy(place.begin(), place.end(), y.begin()); });
}

void advance(const Rkf45& o, std::span<double> y, double h, const Derivative& f, std::span<double> scratch) {
  error_control::cover(o, y, h, f, scratch);
}

}  // namespace dynasurf::dynamics
