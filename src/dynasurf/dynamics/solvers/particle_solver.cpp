#include "dynasurf/dynamics/solvers/particle_solver.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/dynamics/solvers/conjugate_gradients.hpp"

namespace dynasurf {
namespace {

constexpr std::size_t kGrain = 512;  // rows of one parallel piece
constexpr int kPowerIterations = 60;

/// y = weight * M x - h Kv x - h^2 Kx x, rows and columns of pinned particles left out.
struct SystemMatrix {
  const ParticleSystem& system;
  const ForceJacobian& jacobian;
  std::vector<std::vector<Mat3>> blocks;  // beside the rows' columns

  SystemMatrix(const ParticleSystem& s, const ForceJacobian& j, double h) : system(s), jacobian(j), blocks(s.size()) {
    parallel_for(s.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const ForceJacobian::Row& row = j.rows()[i];
        blocks[i].resize(row.columns.size());
        for (std::size_t k = 0; k < row.columns.size(); ++k) blocks[i][k] = -h * row.dfdv[k] - h * h * row.dfdx[k];
      }
    });
  }

  void multiply(std::span<const Vec3> x, std::span<Vec3> y) const {
    parallel_for(x.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        y[i].setZero();
        if (system.is_pinned(i)) continue;
        y[i] = system.masses[i] * x[i];
        const auto& columns = jacobian.rows()[i].columns;
        for (std::size_t k = 0; k < columns.size(); ++k)
          if (!system.is_pinned(columns[k])) y[i] += blocks[i][k] * x[columns[k]];
      }
    });
  }

  std::vector<Mat3> inverse_diagonal() const {
    std::vector<Mat3> inverse(system.size());
    for (std::size_t i = 0; i < system.size(); ++i) {
      Mat3 block = system.masses[i] * Mat3::Identity();
      const auto& columns = jacobian.rows()[i].columns;
      for (std::size_t k = 0; k < columns.size(); ++k)
        if (columns[k] == i) block += blocks[i][k];
      inverse[i] = block.inverse();
    }
    return inverse;
  }
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
    total_force(system.forces, {room->positions, room->velocities}, room->forces);
    for (std::size_t p = 0; p < n; ++p)
      for (std::size_t a = 0; a < 3; ++a) {
        const bool pinned = system.is_pinned(p);
        dydt[3 * p + a] = pinned ? 0 : y[3 * (n + p) + a];
        dydt[3 * (n + p) + a] = pinned ? 0 : room->forces[p][static_cast<Eigen::Index>(a)] / system.masses[p];
      }
  };
}

ImplicitStep ParticleSolver::step(ParticleSystem& system, double h) {
  for (std::size_t p = 0; p < system.size(); ++p)
    if (system.is_pinned(p)) system.velocities[p].setZero();
  if (const auto* implicit = std::get_if<BackwardEuler>(&solver_)) return step_implicit(system, h, *implicit);
  step_explicit(system, h);
  return {};
}

void ParticleSolver::step_explicit(ParticleSystem& system, double h) {
  const std::size_t n = system.size();
  if (n == 0) return;
  y_.resize(6 * n);
  scratch_.resize(kSolverScratch * y_.size());
  std::copy_n(system.positions.data()->data(), 3 * n, y_.data());
  std::copy_n(system.velocities.data()->data(), 3 * n, y_.data() + 3 * n);
  advance(solver_, y_, h, motion_of(system), scratch_);
  std::copy_n(y_.data(), 3 * n, system.positions.data()->data());
  std::copy_n(y_.data() + 3 * n, 3 * n, system.velocities.data()->data());
}

ImplicitStep ParticleSolver::step_implicit(ParticleSystem& system, double h, const BackwardEuler& options) {
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
    const int most = options.max_iterations > 0 ? options.max_iterations : 3 * static_cast<int>(n);
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
  return {found.iterations, found.residual, found.converged, made_definite};
}

Fastest fastest_modes(const ParticleSystem& system) {
  const std::size_t n = system.size();
  ForceJacobian jacobian(n, true);
  fill(jacobian, system, true);
  const auto largest = [&](auto block_of) {
    // A start that is nobody's eigenvector: neighbours differ in sign, as in the stiffest modes.
    std::vector<Vec3> x(n), y(n);
    for (std::size_t i = 0; i < n; ++i) x[i] = Vec3(i % 2 == 0 ? 1 : -1, i % 3 == 0 ? 1 : -1, i % 5 < 2 ? 1 : -1);
    double value = 0;
    for (int k = 0; k < kPowerIterations; ++k) {
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
  return {largest([](const ForceJacobian::Row& r, std::size_t c) -> const Mat3& { return r.dfdx[c]; }),
          largest([](const ForceJacobian::Row& r, std::size_t c) -> const Mat3& { return r.dfdv[c]; })};
}

}  // namespace dynasurf
