#include "dynasurf/dynamics/solvers/solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <string>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/dynamics/solvers/detail/error_control.hpp"

namespace dynasurf::dynamics {
namespace {

constexpr std::array<std::string_view, 3> kBaseMethods{"euler", "midpoint", "rk4"};
constexpr std::array<std::string_view, 2> kStiffenings{"definite", "exact"};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool has_limit(const SolverOptions& solver) {
  return std::holds_alternative<Euler>(solver) || std::holds_alternative<Midpoint>(solver) ||
         std::holds_alternative<Rk4>(solver);
}

double size(std::complex<double> z) { return own::hypot(z.real(), z.imag()); }

/// By which factor one step multiplies a solution exp(z t / h).
std::complex<double> growth(const SolverOptions& solver, std::complex<double> z) {
  if (std::holds_alternative<Euler>(solver)) return 1.0 + z;
  if (std::holds_alternative<Midpoint>(solver)) return 1.0 + z + z * z / 2.0;
  return 1.0 + z + z * z / 2.0 + z * z * z / 6.0 + z * z * z * z / 24.0;
}

}  // namespace

std::span<const std::string_view> names_of(BaseMethod) { return kBaseMethods; }
std::span<const std::string_view> names_of(Stiffening) { return kStiffenings; }

int advance(const SolverOptions& solver, std::span<double> y, double h, const Derivative& f, std::span<double> scratch,
            std::span<const double> units, int most) {
  return std::visit(
      [&](const auto& method) -> int {
        using Method = std::decay_t<decltype(method)>;
        if constexpr (std::is_same_v<Method, BackwardEuler> || std::is_same_v<Method, AutomaticSolver>) {
          throw OptionError("solver " + std::string(Method::name) +
                            " advances particle systems only; expected one of the others");
        } else if constexpr (requires { method.tolerance; }) {
          return error_control::cover(method, y, h, f, scratch, units, most);
        } else {
          advance(method, y, h, f, scratch);
          return 1;
        }
      },
      solver);
}

double stability_interval(const SolverOptions& solver) {
  // RK4: the negative root of 1 + z + z^2/2 + z^3/6 + z^4/24 = 1.
  return std::holds_alternative<Rk4>(solver) ? 2.785293563405282 : has_limit(solver) ? 2.0 : kInfinity;
}

double oscillator_limit_s(const SolverOptions& solver, double stiffness, double damping) {
  if (!has_limit(solver) || (stiffness <= 0 && damping <= 0)) return kInfinity;
  // Exponents of the two solutions: roots of s^2 + damping s + stiffness.
  const double inside = damping * damping / 4 - stiffness, root = std::sqrt(std::abs(inside));
  const bool swings = inside < 0;
  const std::complex<double> fast(-damping / 2 - (swings ? 0 : root), swings ? -root : 0);
  const std::complex<double> slow = swings ? std::conj(fast) : stiffness > 0 ? stiffness / fast.real() : 0;
  const auto holds = [&](double h) {
    // Rounding must not make an undamped oscillator grow where it keeps its size.
    const double most = 1 + 1e-12;
    return size(growth(solver, h * fast)) <= most && size(growth(solver, h * slow)) <= most;
  };
  // The stable steps of these methods are one interval from 0 along each ray; find its end from above.
  const double longest = 3 / std::max(size(fast), size(slow));
  double good = 0, bad = longest;
  for (int n = 0; n < 200 && good == 0; ++n, bad *= 0.97)
    if (holds(bad)) good = bad;
  if (good == 0) return 0;
  bad = good / 0.97;
  for (int n = 0; n < 60; ++n) {
    const double middle = (good + bad) / 2;
    (holds(middle) ? good : bad) = middle;
  }
  return good;
}

double step_limit_s(const SolverOptions& solver, double mass_kg, std::size_t particles, double drag) {
  if (drag <= 0 || particles == 0) return kInfinity;
  return stability_interval(solver) * mass_kg / (particles * drag);
}

}  // namespace dynasurf::dynamics
