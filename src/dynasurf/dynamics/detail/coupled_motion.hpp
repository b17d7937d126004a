#pragma once
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"

namespace dynasurf::dynamics {

/// The motion of particles that act on each other, or that forces of the caller act on: what `evolve` uses wherever
/// particles cannot be advanced one by one.
class CoupledMotion {
 public:
  /// Errors of speeds are judged by the way that they lead to before `least_drag` (kg/s) ends it.
  CoupledMotion(const TriMesh& start, double mass_kg, std::vector<Force> forces, const SolverOptions& solver,
                double least_drag = 0);

  /// One step. `moving` names the particles that move; the others are held where `vertices` has them. `state` holds
  /// x, y, z, vx, vy, vz of each moving one, and is advanced. Returns into how many steps the solver cut it; after
  /// `most` of them it stops short.
  int step(std::span<const Vec3> vertices, std::span<const std::uint32_t> moving, std::span<double> state, double h,
           int most);

  /// The largest step that is stable by what the forces say of their slopes now (ODE-LIMIT), and what sets it.
  struct Limit {
    double step_s = 0;
    Fastest modes;
  };
  Limit limit(double least_drag);

  /// Steps in which the linear system was not solved to the tolerance.
  int unsolved_steps() const { return unsolved_steps_; }

 private:
  ParticleSystem system_;
  SolverOptions options_;
  ParticleSolver solver_;
  ModeSearch search_;
  int unsolved_steps_ = 0;
};

}  // namespace dynasurf::dynamics
