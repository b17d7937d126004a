#include "dynasurf/dynamics/solvers/solver.hpp"

#include <limits>

namespace dynasurf {

void advance(const SolverOptions& solver, std::span<double> y, double h, const Derivative& f,
             std::span<double> scratch) {
  std::visit([&](const auto& method) { advance(method, y, h, f, scratch); }, solver);
}

double stability_interval(const SolverOptions& solver) {
  // RK4: the negative root of 1 + z + z^2/2 + z^3/6 + z^4/24 = 1.
  return std::holds_alternative<Rk4>(solver) ? 2.785293563405282 : 2.0;
}

double step_limit_s(const SolverOptions& solver, double mass_kg, std::size_t particles, double drag) {
  if (drag <= 0 || particles == 0) return std::numeric_limits<double>::infinity();
  return stability_interval(solver) * mass_kg / (static_cast<double>(particles) * drag);
}

}  // namespace dynasurf
