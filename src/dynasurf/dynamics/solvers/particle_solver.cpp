#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/dynamics/solvers/detail/conjugate_gradients.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"

namespace dynasurf::dynamics {
namespace {

constexpr std::size_t kRowGrain = 512;  // rows of one parallel piece
constexpr int kPowerIterations = 60;
constexpr int kMoreIterations = 12;  // where a former search ended nearby
constexpr double kNewShare = 0.2;    // of such a start that is not the former end

/// M - h Kv - h^2 Kx without the rows and columns of pinned particles, the blocks of all rows one after another.
class SystemMatrix {
 public:
  SystemMatrix(const ParticleSystem& system, const ForceJacobian& jacobian, double h) : first_(system.size() + 1, 0) {
    const std::size_t n = system.size();
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; ++i) count += jacobian.rows()[i].columns.size() + 1;
    columns_.reserve(count);
    blocks_.reserve(count);
    for (std::size_t i = 0; i < n; ++i) {
      if (!system.is_pinned(i)) append_row(system, jacobian.rows()[i], i, h);
      first_[i + 1] = blocks_.size();
    }
  }

  void multiply(std::span<const Vec3> x, std::span<Vec3> y) const {
    parallel_for(x.size(), kRowGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Vec3 sum = Vec3::Zero();
        for (std::size_t k = first_[i]; k < first_[i + 1]; ++k) sum += blocks_[k] * x[columns_[k]];
        y[i] = sum;
      }
    });
  }

  std::vector<Mat3> inverse_diagonal() const {
    std::vector<Mat3> inverse(first_.size() - 1, Mat3::Identity());
    for (std::size_t i = 0; i < inverse.size(); ++i)
      if (first_[i] < first_[i + 1]) inverse[i] = blocks_[first_[i]].inverse();
    return inverse;
  }

 private:
  /// The diagonal block comes first.
  void append_row(const ParticleSystem& system, const ForceJacobian::Row& row, std::size_t i, double h) {
    const std::size_t diagonal = blocks_.size();
    columns_.push_back(i);
    blocks_.push_back(system.masses[i] * Mat3::Identity());
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
      if (system.is_pinned(row.columns[k])) continue;
      const Mat3 block = -h * row.dfdv[k] - h * h * row.dfdx[k];
      if (row.columns[k] == i) {
        blocks_[diagonal] += block;
        continue;
      }
      columns_.push_back(row.columns[k]);
      blocks_.push_back(block);
    }
  }

  std::vector<std::size_t> first_;  // of each row
  std::vector<std::uint32_t> columns_;
  std::vector<Mat3> blocks_;
};

void fill(ForceJacobian& jacobian, const ParticleSystem& system, bool definite) {
  jacobian.clear(definite);
  for (const Force& force : system.forces)
    if (force.jacobian) force.jacobian(system.state(), jacobian);
}

}  // namespace

Derivative motion_of(const ParticleSystem& system) {
  struct Buffers {
    std::vector<Vec3> positions, velocities, forces;
  };
  const std::size_t n = system.size();
  const auto room =
      std::make_shared<Buffers>(Buffers{std::vector<Vec3>(n), std::vector<Vec3>(n), std::vector<Vec3>(n)});
  return [&system, room, n](std::span<const double> y, std::span<double> dydt) {
    std::copy_n(y.data(), 3 * n, room->positions.data()->data());
    std::copy_n(y.data() + 3 * n, 3 * n, room->velocities.data()->data());
    total_force(system.forces, {room->positions, room->velocities, system.pinned}, room->forces);
    for (std::size_t p = 0; p < n; ++p)
      for (std::size_t a = 0; a < 3; ++a) {
        const bool pinned = system.is_pinned(p);
        dydt[3 * p + a] = pinned ? 0 : y[3 * (n + p) + a];
        dydt[3 * (n + p) + a] = pinned ? 0 : room->forces[p][a] / system.masses[p];
      }
  };
}

SolverWork ParticleSolver::step(ParticleSystem& system, double h, int most) {
  for (std::size_t p = 0; p < system.size(); ++p)
    if (system.is_pinned(p)) system.velocities[p].setZero();
  if (const auto* implicit = std::get_if<BackwardEuler>(&solver_)) return step_implicit(system, h, *implicit);
  return step_explicit(system, h, most);
}

SolverWork ParticleSolver::step_explicit(ParticleSystem& system, double h, int most) {
  const std::size_t n = system.size();
  if (n == 0) return {};
  y_.resize(6 * n);
  scratch_.resize(kSolverScratch * y_.size());
  std::copy_n(system.positions.data()->data(), 3 * n, y_.data());
  std::copy_n(system.velocities.data()->data(), 3 * n, y_.data() + 3 * n);
  units_.resize(6 * n, speed_unit_);
  std::fill_n(units_.begin(), 3 * n, 1.0);
  const int steps = advance(solver_, y_, h, motion_of(system), scratch_, units_, most);
  std::copy_n(y_.data(), 3 * n, system.positions.data()->data());
  std::copy_n(y_.data() + 3 * n, 3 * n, system.velocities.data()->data());
  return {.steps = steps};
}

SolverWork ParticleSolver::step_implicit(ParticleSystem& system, double h, const BackwardEuler& options) {
  const std::size_t n = system.size();
  if (!jacobian_ || jacobian_->rows().size() != n) jacobian_.emplace(n);
  std::vector<Vec3> force(n), right(n), change(n);
  total_force(system.forces, system.state(), force);

  const auto solve = [&](bool definite) {
    fill(*jacobian_, system, definite);
    for (std::size_t i = 0; i < n; ++i) {
      right[i].setZero();
      if (system.is_pinned(i)) continue;
      Vec3 ahead = Vec3::Zero();  // Kx v
      const ForceJacobian::Row& row = jacobian_->rows()[i];
      for (std::size_t k = 0; k < row.columns.size(); ++k) ahead += row.dfdx[k] * system.velocities[row.columns[k]];
      right[i] = h * (force[i] + h * ahead);
    }
    const SystemMatrix matrix(system, *jacobian_, h);
    const int most = options.max_iterations > 0 ? options.max_iterations : 3 * n;
    return conjugate_gradients([&](auto x, auto y) { matrix.multiply(x, y); }, matrix.inverse_diagonal(), right, change,
                               options.tolerance, most);
  };
  const bool exact = options.stiffness == Stiffening::exact;
  CgResult found = solve(!exact);
  const bool made_definite = exact && !found.is_definite;
  if (made_definite) found = solve(true);

  for (std::size_t i = 0; i < n; ++i) {
    if (system.is_pinned(i)) continue;
    system.velocities[i] += change[i];
    system.positions[i] += h * system.velocities[i];
  }
  return {1, found.iterations, found.residual, found.converged, made_definite};
}

Fastest fastest_modes(const ParticleSystem& system, ModeSearch* former) {
  const std::size_t n = system.size();
  ForceJacobian jacobian(n, true);
  fill(jacobian, system, true);
  const auto largest = [&](std::vector<Vec3>& x, auto block_of) {
    // A start that is nobody's eigenvector: neighbours differ in sign, as in the stiffest modes. Where a former search
    // ended is nearer, and the rest of the start finds modes that have become stiffer since.
    const bool is_new = x.size() != n;
    const double share = is_new ? 1 : kNewShare / std::sqrt(3.0 * n);
    x.resize(n, Vec3::Zero());
    for (std::size_t i = 0; i < n; ++i)
      x[i] += share * Vec3(i % 2 == 0 ? 1 : -1, i % 3 == 0 ? 1 : -1, i % 5 < 2 ? 1 : -1);
    std::vector<Vec3> y(n);
    double value = 0;
    for (int k = 0; k < (is_new ? kPowerIterations : kMoreIterations); ++k) {
      double squared = 0;
      for (std::size_t i = 0; i < n; ++i) {
        y[i].setZero();
        if (system.is_pinned(i)) continue;
        const ForceJacobian::Row& row = jacobian.rows()[i];
        for (std::size_t c = 0; c < row.columns.size(); ++c) y[i] -= block_of(row, c) * x[row.columns[c]];
        y[i] /= system.masses[i];
        squared += y[i].squaredNorm();
      }
      double before = 0;
      for (const Vec3& v : x) before += v.squaredNorm();
      if (!(squared > 0) || !(before > 0)) return 0.0;
      value = std::sqrt(squared / before);
      for (std::size_t i = 0; i < n; ++i) x[i] = y[i] / std::sqrt(squared);
    }
    return value;
  };
  ModeSearch own;
  ModeSearch& search = former != nullptr ? *former : own;
  return {
      largest(search.stiffest, [](const ForceJacobian::Row& r, std::size_t c) -> const Mat3& { return r.dfdx[c]; }),
      largest(search.most_damped, [](const ForceJacobian::Row& r, std::size_t c) -> const Mat3& { return r.dfdv[c]; })};
}

}  // namespace dynasurf::dynamics
