#include "dynasurf/dynamics/evolve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/dynamics/detail/border_stop.hpp"
#include "dynasurf/dynamics/detail/coupled_motion.hpp"
#include "dynasurf/dynamics/detail/distance_history.hpp"
#include "dynasurf/dynamics/detail/field_force.hpp"
#include "dynasurf/dynamics/detail/rest_watch.hpp"
#include "dynasurf/dynamics/detail/step_plan.hpp"
#include "dynasurf/dynamics/forces/forces.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"

namespace dynasurf::dynamics {
namespace {

constexpr std::array<std::string_view, 4> kStopPoints{"entry", "centre", "backtrack", "subvoxel"};
constexpr std::array<std::string_view, 4> kStopReasons{"all_stopped", "at_rest", "max_steps", "diverged"};

constexpr std::size_t kParticleGrain = 1024;  // particles of one parallel piece
constexpr std::size_t kBatch = 64;            // particles advanced together: their state and scratch stay in the cache
constexpr double kFastParticle = 0.5;         // voxels per step worth a note (A.4)
constexpr double kFarthestVoxel = 1e6;        // where a start may lie
constexpr int kStepsBetweenChecks = 64;       // for a request to stop
constexpr int kStepsBetweenLimits = 16;       // of a coupled run: its forces stiffen as the mesh shrinks

void check_inputs(const TriMesh& start, field::FieldView field, const Image& border) {
  if (start.vertices.empty()) throw InputError("evolve: the start mesh has no vertices; expected at least one");
  if (field.grid().size() == 0) throw InputError("evolve: the field has no voxels; expected a field to move in");
  if (field.grid().dims != border.grid.dims || field.grid().spacing != border.grid.spacing)
    throw InputError("evolve: field and border lie on different grids; expected the same size and spacing");
  for (const Vec3& p : start.vertices)
    if (!p.allFinite() || p.cwiseQuotient(field.grid().spacing).cwiseAbs().maxCoeff() > kFarthestVoxel)
      throw InputError("evolve: a start vertex is not finite or farther than a million voxels from the grid");
}

void check_additions(const Additions& own, field::FieldView field) {
  for (const Force& force : own.forces)
    if (!force.accumulate) throw InputError("evolve: the force '" + force.name + "' has no function; expected one");
  if (!own.drag) return;
  if (own.drag->grid.dims != field.grid().dims)
    throw InputError("evolve: the drag lies on another grid than the field; expected the same size");
  for (const float drag : own.drag->values)
    if (!(drag >= 0) || std::isinf(drag)) throw InputError("evolve: a drag is negative or not finite; expected >= 0");
}

/// The drag of a run: a number, or a map with its ends.
struct Drag {
  std::optional<Image> map;
  double least = 0, most = 0;
};

Drag drag_of(field::FieldView field, const Image& border, const Evolution& o, const Additions& own) {
  Drag drag{own.drag ? own.drag : drag_map(o.damping, field, border, o.force.drag), o.force.drag, o.force.drag};
  if (drag.map) {
    const auto [least, most] = std::minmax_element(drag.map->values.begin(), drag.map->values.end());
    drag.least = *least;
    drag.most = *most;
  }
  return drag;
}

bool needs_coupling(const Evolution& o, const Additions& own) {
  return !std::holds_alternative<FreeModel>(o.model) || std::holds_alternative<BackwardEuler>(o.solver) ||
         !own.forces.empty();
}

/// All forces on particles that are not advanced one by one. `drag` and `field` must outlive them.
std::vector<Force> all_forces(const TriMesh& start, field::FieldView field, const Drag& drag, const Evolution& o,
                              const Additions& own) {
  std::vector<Force> forces = internal_forces(o.model, start, field, o.force.sampling);
  forces.push_back(field_pull(field, o.force.strength, o.force.sampling));
  if (drag.most > 0) forces.push_back(drag.map ? drag_force(*drag.map) : drag_force(drag.most));
  forces.insert(forces.end(), own.forces.begin(), own.forces.end());
  return forces;
}

/// What one piece of the particles reports of a step.
struct StepReport {
  double speed = 0;           // largest, mm/s
  double voxels_squared = 0;  // largest displacement by the field
  bool finite = true;
};

/// A run of any model. Particles that still move are kept packed: with the free model, a stopped one costs nothing.
class Run {
 public:
  Run(const TriMesh& start, field::FieldView field, const Image& border, const Evolution& options, const Additions& own)
      : options_(options),
        own_(own),
        field_(field),
        grid_(field.grid()),
        smallest_spacing_(field.grid().spacing.minCoeff()),
        room_(room_of(field.grid(), start)),
        pull_(checked_pull(field)),
        drag_(drag_of(field, border, options, own)),
        coupled_(couple(start, field)),
        plan_(plan_steps(options, start.vertices.size(), pace(start.vertices.size()), room_, smallest_spacing_)),
        motion_(free_motion(field, options.force, plan_.mass_kg, drag_.map ? &*drag_.map : nullptr)),
        stop_(border, options.stop, own.planes, own.stop),
        rings_(mesh::vertex_rings(start)),
        rest_(start.vertices) {
    const std::size_t n = start.vertices.size();
    result_.mesh = start;
    result_.step_s = plan_.step_s;
    result_.stopped.assign(n, 0);
    state_.assign(6 * n, 0.0);
    before_.resize(n);
    hit_.resize(n);
    moving_.resize(n);
    for (std::uint32_t v = 0; v < n; ++v) {
      moving_[v] = v;
      for (std::size_t a = 0; a < 3; ++a) state_[6 * v + a] = start.vertices[v][a];
    }
    const double speed = speed_unit(drag_.least, plan_.mass_kg);
    for (std::size_t p = 0; p < kBatch; ++p) units_.insert(units_.end(), {1, 1, 1, speed, speed, speed});
    if (options.histories) history_.emplace(border, n);
  }

  EvolutionResult operator()(const Progress& progress) {
    note_step();
    result_.reason = StopReason::max_steps;
    keep_trajectory(options_.trajectory_every > 0);
    int rested_steps = 0;
    bool begun = false;
    while (result_.steps < options_.end.max_steps && solver_steps_ < most_solver_steps()) {
      if (result_.steps % kStepsBetweenChecks == 0) progress.check();
      if (result_.steps % kStepsBetweenLimits == 0) keep_step_stable();
      if (!move()) {
        result_.reason = StopReason::diverged;
        break;
      }
      ++result_.steps;
      retire_stopped();
      if (options_.smooth_every > 0 && result_.steps % options_.smooth_every == 0) {
        mesh::smooth(result_.mesh.vertices, rings_, moving_, options_.smooth_during, smallest_spacing_);
        follow_smoothing();
        retire_stopped();
      }
      if (history_) {
        result_.histories.push_back(history_->count(result_.mesh.vertices, moving_, newly_stopped_));
        newly_stopped_.clear();
      }
      keep_trajectory(options_.trajectory_every > 0 && result_.steps % options_.trajectory_every == 0);
      if (own_.watch) own_.watch(result_.steps, result_.mesh);
      if (moving_.empty()) {
        result_.reason = StopReason::all_stopped;
        break;
      }
      const bool rests = count_at_rest() >= options_.end.still_share * result_.stopped.size();
      begun = begun || !rests || result_.steps > plan_.start_steps;
      rested_steps = rests && begun ? rested_steps + 1 : 0;
      if (rested_steps >= options_.end.still_steps) {
        result_.reason = StopReason::at_rest;
        break;
      }
    }
    return finish();
  }

 private:
  static double checked_pull(field::FieldView field) {
    const double pull = field.largest();
    if (!std::isfinite(pull)) throw InputError("evolve: the field has a vector that is not finite");
    return pull;
  }

  std::optional<CoupledMotion> couple(const TriMesh& start, field::FieldView field) const {
    if (!needs_coupling(options_, own_)) return std::nullopt;
    return CoupledMotion(start, options_.mass_kg, all_forces(start, field, drag_, options_, own_), options_.solver,
                         drag_.least);
  }

  /// Shortens an automatic step that the mesh has outgrown.
  void keep_step_stable() {
    if (!coupled_ || options_.step_s > 0 || !std::isfinite(plan_.limit_s)) return;
    const auto now = coupled_->limit(drag_.least);
    if (longest_stable_s(now.step_s) >= plan_.step_s || !(now.step_s > 0)) return;
    plan_.shorten(now.step_s);
    result_.step_s = plan_.step_s;
    result_.step_explained = explain_step(plan_, false, limit_in_words(now.modes));
  }

  Pace pace(std::size_t particles) {
    const double limit_s = coupled_ ? coupled_->limit(drag_.least).step_s
                                    : step_limit_s(options_.solver, options_.mass_kg, particles, drag_.most);
    return {pull_, drag_.least, limit_s, coupled_.has_value()};
  }

  /// Steps that a solver cuts its own into count half.
  int most_solver_steps() const { return 2 * std::min(options_.end.max_steps, std::numeric_limits<int>::max() / 2); }

  /// One step of the solver for all moving particles, and STOP-VOXEL on their paths. False, with the mesh as it was
  /// before, when the motion blew up.
  bool move() {
    if (coupled_)
      solver_steps_ +=
          coupled_->step(result_.mesh.vertices, moving_, state_, plan_.step_s, most_solver_steps() - solver_steps_);
    reports_.assign((moving_.size() + kParticleGrain - 1) / kParticleGrain, {});
    parallel_for(moving_.size(), kParticleGrain, [this](std::size_t begin, std::size_t end) {
      StepReport& report = reports_[begin / kParticleGrain];
      for (std::size_t b = begin; b < end; b += kBatch) move_batch(b, std::min(end, b + kBatch), report);
    });
    StepReport all;
    for (const StepReport& r : reports_) {
      all.speed = std::max(all.speed, r.speed);
      all.voxels_squared = std::max(all.voxels_squared, r.voxels_squared);
      all.finite = all.finite && r.finite;
    }
    if (!all.finite || all.speed > plan_.runaway) {
      for (std::size_t s = 0; s < moving_.size(); ++s) result_.mesh.vertices[moving_[s]] = before_[s];
      return false;
    }
    if (all.voxels_squared > fastest_step_squared_) {
      fastest_step_squared_ = all.voxels_squared;
      fastest_step_ = result_.steps + 1;
    }
    return true;
  }

  void move_batch(std::size_t begin, std::size_t end, StepReport& report) {
    std::array<double, 6 * kBatch * kSolverScratch> scratch;
    const std::span<double> state = std::span(state_).subspan(6 * begin, 6 * (end - begin));
    for (std::size_t s = begin; s < end; ++s) before_[s] = result_.mesh.vertices[moving_[s]];
    if (!coupled_)
      advance(options_.solver, state, plan_.step_s, motion_, scratch, std::span(units_).first(state.size()));
    for (std::size_t s = begin; s < end; ++s) {
      Eigen::Map<Vec3> position(&state_[6 * s]), velocity(&state_[6 * s + 3]);
      if (!position.allFinite() || !velocity.allFinite()) {
        report.finite = false;
        return;
      }
      keep_in_room(position, velocity);
      report.speed = std::max(report.speed, velocity.norm());
      report.voxels_squared =
          std::max(report.voxels_squared, (position - before_[s]).cwiseQuotient(grid_.spacing).squaredNorm());
      hit_[s] = stop_on_path(before_[s], before_[s], position);
      result_.mesh.vertices[moving_[s]] = position;
    }
  }

  void keep_in_room(Eigen::Map<Vec3>& position, Eigen::Map<Vec3>& velocity) const {
    for (int a = 0; a < 3; ++a) {
      if (position[a] >= room_.low[a] && position[a] <= room_.high[a]) continue;
      position[a] = std::clamp(position[a], room_.low[a], room_.high[a]);
      velocity[a] = 0;
    }
  }

  /// Ends the way at a stop on it; 1 when there is one, else 0.
  template <class Point>
  std::uint8_t stop_on_path(const Vec3& step_begin, const Vec3& from, Point& to) const {
    const std::optional<Vec3> held = stop_.on_path(step_begin, from, to);
    if (held) to = *held;
    return held ? 1 : 0;
  }

  /// Smoothing is a part of the motion: a particle that it would push through the border stops there as well.
  void follow_smoothing() {
    for (std::size_t s = 0; s < moving_.size(); ++s) {
      Eigen::Map<Vec3> position(&state_[6 * s]);
      Vec3& smoothed = result_.mesh.vertices[moving_[s]];
      hit_[s] = 0;
      if (smoothed == position) continue;
      hit_[s] = stop_on_path(before_[s], position, smoothed);
      position = smoothed;
    }
  }

  /// Keeps the moving particles packed, in ascending order.
  void retire_stopped() {
    std::size_t kept = 0;
    for (std::size_t s = 0; s < moving_.size(); ++s) {
      const std::uint32_t v = moving_[s];
      if (hit_[s] != 0) {
        result_.stopped[v] = 1;
        if (history_) newly_stopped_.push_back(v);
        continue;
      }
      if (kept != s) {
        moving_[kept] = v;
        before_[kept] = before_[s];
        std::copy_n(&state_[6 * s], 6, &state_[6 * kept]);
      }
      ++kept;
    }
    moving_.resize(kept);
  }

  /// Stopped particles are at rest, too.
  std::size_t count_at_rest() {
    return result_.stopped.size() - moving_.size() +
           rest_.count(moving_, result_.mesh.vertices, before_, result_.steps, plan_);
  }

  void keep_trajectory(bool now) {
    if (!now) return;
    TrajectoryStep kept{result_.steps, result_.mesh.vertices, std::vector<Vec3>(result_.mesh.vertices.size()),
                        result_.stopped};
    for (std::size_t v = 0; v < kept.places.size(); ++v)
      kept.pulls[v] = result_.stopped[v] != 0
                          ? Vec3(Vec3::Zero())
                          : Vec3(options_.force.strength * field_.at_point(kept.places[v], options_.force.sampling));
    result_.trajectory.push_back(std::move(kept));
  }

  EvolutionResult finish() {
    keep_trajectory(options_.trajectory_every > 0 && result_.steps % options_.trajectory_every != 0);
    const auto stopped = std::count(result_.stopped.begin(), result_.stopped.end(), std::uint8_t{1});
    result_.stopped_fraction = 1.0 * stopped / result_.stopped.size();
    note_fast_particle();
    if (coupled_ && coupled_->unsolved_steps() > 0)
      note(Severity::warning, "evolve.unsolved_steps", [&](auto& text) {
        text << "the linear system was not solved to the tolerance in " << coupled_->unsolved_steps() << " of "
             << result_.steps << " steps";
      });
    if (result_.reason == StopReason::max_steps) note_max_steps();
    if (result_.reason == StopReason::diverged) {
      note(Severity::failure, "evolve.diverged", [&](auto& text) {
        text << "the motion blew up after " << result_.steps << " steps; a shorter step is needed";
      });
    } else {
      mesh::smooth(result_.mesh, options_.smooth_after, smallest_spacing_);
    }
    return std::move(result_);
  }

  void note_step() {
    if (plan_.step_s > plan_.limit_s)
      note(Severity::warning, "evolve.step_above_limit", [&](auto& text) {
        text << "the time step " << plan_.step_s << " s is above the stable limit " << plan_.limit_s << " s";
      });
    result_.step_explained = explain_step(plan_, options_.step_s > 0, limit_in_words());
    // Where the drag alone bounds the step, it is that of table 4.2; other limits are worth a remark.
    if (coupled_ && options_.step_s <= 0)
      note(Severity::info, "evolve.step_chosen",
           [&](auto& text) { text << "the time step is " << plan_.step_s << " s: " << result_.step_explained; });
  }

  /// What the largest stable step comes from.
  std::string limit_in_words() {
    if (coupled_) return limit_in_words(coupled_->limit(drag_.least).modes);
    TextOutput text;
    text << "the drag of " << drag_.most << " kg/s on particles of " << plan_.mass_kg << " kg";
    return text.str();
  }
  static std::string limit_in_words(const Fastest& modes) {
    TextOutput text;
    if (modes.stiffness > 0) text << "the stiffest motion (" << std::sqrt(modes.stiffness) << " rad/s) and ";
    text << "the strongest damping (" << modes.damping << " 1/s)";
    return text.str();
  }

  void note_max_steps() {
    note(Severity::warning, "evolve.max_steps", [&](auto& text) {
      text << "the motion was not at rest after " << result_.steps << " steps of " << plan_.step_s
           << " s: " << moving_.size() << " of " << result_.stopped.size() << " particles still moved";
      if (solver_steps_ > result_.steps) text << "; the solver had to cut them into " << solver_steps_;
      if (options_.step_s <= 0 && plan_.is_bounded_by_stability())
        text << "; stability bounds the step, which solver backward_euler does without";
    });
  }

  void note_fast_particle() {
    if (fastest_step_squared_ > kFastParticle * kFastParticle)
      note(Severity::warning, "evolve.fast_particle", [&](auto& text) {
        text << "a particle moved " << std::sqrt(fastest_step_squared_) << " voxels in step " << fastest_step_
             << "; above " << kFastParticle << " its path is coarse, a shorter step follows the field better";
      });
  }

  template <class Write>
  void note(Severity severity, const char* code, Write write) {
    TextOutput text;
    write(text);
    result_.notes.push_back({severity, code, text.str()});
  }

  const Evolution& options_;
  const Additions& own_;
  const field::FieldView field_;
  const Grid grid_;
  const double smallest_spacing_;
  const Room room_;
  const double pull_;
  const Drag drag_;
  std::optional<CoupledMotion> coupled_;
  StepPlan plan_;
  const Derivative motion_;
  const BorderStop stop_;
  const mesh::VertexRings rings_;
  RestWatch rest_;
  std::optional<DistanceHistory> history_;
  EvolutionResult result_;

  std::vector<std::uint32_t> moving_;  // vertices that move, ascending; the arrays below are parallel to it
  std::vector<double> state_;          // x, y, z, vx, vy, vz
  std::vector<Vec3> before_;           // positions before the step
  std::vector<std::uint8_t> hit_;      // met the border in this step
  std::vector<double> units_;          // of the errors of a batch
  std::vector<StepReport> reports_;
  std::vector<std::uint32_t> newly_stopped_;
  double fastest_step_squared_ = 0;
  int fastest_step_ = 0;
  int solver_steps_ = 0;  // of a coupled run: into which its steps were cut
};

}  // namespace

std::span<const std::string_view> names_of(StopPoint) { return kStopPoints; }
std::string_view name_of(StopReason reason) { return kStopReasons[static_cast<std::size_t>(reason)]; }

EvolutionResult evolve(const TriMesh& start, field::FieldView field, const Image& border, const Evolution& options,
                       const Progress& progress, const Additions& own) {
  Evolution checked = options;
  check_options(checked, "evolve");
  checked.solver = solver_for(checked.model, checked.solver);
  check_inputs(start, field, border);
  const BorderPlanes* planes = own.planes;
  if (planes != nullptr && planes->grid.dims != border.grid.dims)
    throw InputError("evolve: the border's planes lie on another grid than the border; expected the same size");
  check_additions(own, field);
  return Run(start, field, border, checked, own)(progress);
}

}  // namespace dynasurf::dynamics
