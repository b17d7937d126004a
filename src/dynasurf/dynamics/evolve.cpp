#include "dynasurf/dynamics/evolve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/dynamics/border_path.hpp"
#include "dynasurf/dynamics/coupled_motion.hpp"
#include "dynasurf/dynamics/field_force.hpp"
#include "dynasurf/dynamics/forces/forces.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"
#include "dynasurf/mesh/border_distance.hpp"

namespace dynasurf {
namespace {

constexpr std::array<std::string_view, 4> kStopPoints{"entry", "centre", "backtrack", "subvoxel"};
constexpr std::array<std::string_view, 4> kStopReasons{"all_stopped", "at_rest", "max_steps", "diverged"};

constexpr std::size_t kGrain = 1024;     // particles of one parallel piece
constexpr std::size_t kBatch = 64;       // particles advanced together: their state and scratch stay in the cache
constexpr double kShareOfLimit = 0.8;    // of the largest stable step
constexpr double kVoxelsPerStep = 0.3;   // the automatic step keeps the steady speed below this
constexpr double kFastParticle = 0.5;    // voxels per step worth a note (A.4)
constexpr double kRunaway = 100;         // times the fastest speed the field can give
constexpr double kFarthestVoxel = 1e6;   // where a start may lie
constexpr int kStepsBetweenChecks = 64;  // for a request to stop
constexpr int kStepsBetweenLimits = 16;  // of a coupled run: its forces stiffen as the mesh shrinks

/// The room of the particles: the cells of the grid and the box of the start. Who starts outside the grid may come in
/// from there, but nobody can leave.
struct Room {
  Vec3 low, high;
  double diagonal_mm() const { return (high - low).norm(); }
};

Room room_of(const Grid& grid, const TriMesh& start) {
  Room room{-grid.spacing / 2, Vec3(grid.dims[0] - 0.5, grid.dims[1] - 0.5, grid.dims[2] - 0.5)};
  room.high = room.high.cwiseProduct(grid.spacing);
  for (const Vec3& p : start.vertices) {
    room.low = room.low.cwiseMin(p);
    room.high = room.high.cwiseMax(p);
  }
  return room;
}

/// What follows from the options before the first step.
struct Plan {
  double mass_kg = 0;  // of one particle
  double fastest = 0;  // bound of the speed that the field can give, mm/s
  double limit_s = 0, automatic_s = 0, step_s = 0;
  double runaway = 0;   // faster is a blow-up, mm/s
  double rest_mm = 0;   // who moves less in a step is at rest
  double stray_mm = 0;  // and who strays no farther in so many steps
  int stray_steps = 0;
};

/// `drag` is the least anywhere, `limit_s` the largest stable step of what moves the particles.
Plan make_plan(const Evolution& o, std::size_t particles, double pull, double drag, double limit_s, bool is_coupled,
               const Room& room, double smallest_spacing_mm) {
  Plan plan;
  plan.mass_kg = o.mass_kg / static_cast<double>(particles);
  // Falling all through the room, or the steady speed at which the drag balances the field.
  plan.fastest = std::sqrt(2 * o.force.strength * pull / plan.mass_kg * room.diagonal_mm());
  if (drag > 0) plan.fastest = std::min(plan.fastest, o.force.strength * pull / drag);
  plan.limit_s = limit_s;
  const double by_speed =
      plan.fastest > 0 ? kVoxelsPerStep * smallest_spacing_mm / plan.fastest : std::numeric_limits<double>::infinity();
  plan.automatic_s = std::min(kShareOfLimit * plan.limit_s, by_speed);
  if (!std::isfinite(plan.automatic_s)) plan.automatic_s = 1;  // no field, no drag: nothing moves
  if (plan.automatic_s <= 0 && o.step_s <= 0)
    throw OptionError("option evolve.solver is euler; expected another one, or drag: without, every step grows");
  plan.step_s = o.step_s > 0 ? o.step_s : plan.automatic_s;
  if (plan.automatic_s <= 0) plan.automatic_s = plan.step_s;
  plan.runaway = kRunaway * plan.fastest;
  // Internal forces may be faster than the field; nothing sound crosses the room in a step.
  if (is_coupled) plan.runaway = std::max(plan.runaway, room.diagonal_mm() / plan.step_s);
  // In a shorter step a particle covers less ground without being nearer to rest. Internal forces may need a step so
  // short that it tells nothing of the speed of the field: there, the field's own step is the measure.
  const double usual_s = is_coupled && std::isfinite(by_speed) ? by_speed : plan.automatic_s;
  plan.rest_mm = o.end.still_move * smallest_spacing_mm * std::min(1.0, plan.step_s / usual_s);
  plan.stray_mm = o.end.still_radius * smallest_spacing_mm;
  plan.stray_steps = static_cast<int>(std::min(plan.stray_mm / plan.rest_mm, 1e9));
  return plan;
}

void check_inputs(const TriMesh& start, const VectorField& field, const Image& border) {
  if (start.vertices.empty()) throw InputError("evolve: the start mesh has no vertices; expected at least one");
  if (field.grid.size() == 0) throw InputError("evolve: the field has no voxels; expected a field to move in");
  if (field.grid.dims != border.grid.dims || field.grid.spacing != border.grid.spacing)
    throw InputError("evolve: field and border lie on different grids; expected the same size and spacing");
  for (const Vec3& p : start.vertices)
    if (!p.allFinite() || p.cwiseQuotient(field.grid.spacing).cwiseAbs().maxCoeff() > kFarthestVoxel)
      throw InputError("evolve: a start vertex is not finite or farther than a million voxels from the grid");
}

void check_additions(const Additions& own, const VectorField& field) {
  for (const Force& force : own.forces)
    if (!force.accumulate) throw InputError("evolve: the force '" + force.name + "' has no function; expected one");
  if (!own.drag) return;
  if (own.drag->grid.dims != field.grid.dims)
    throw InputError("evolve: the drag lies on another grid than the field; expected the same size");
  for (const float drag : own.drag->values)
    if (!(drag >= 0) || std::isinf(drag)) throw InputError("evolve: a drag is negative or not finite; expected >= 0");
}

/// The drag of a run: a number, or a map with its ends.
struct Drag {
  std::optional<Image> map;
  double least = 0, most = 0;
};

Drag drag_of(const VectorField& field, const Image& border, const Evolution& o, const Additions& own) {
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
std::vector<Force> all_forces(const TriMesh& start, const VectorField& field, const Drag& drag, const Evolution& o,
                              const Additions& own) {
  std::vector<Force> forces = internal_forces(o.model, start, field, o.force.sampling);
  forces.push_back(field_pull(field, o.force.strength, o.force.sampling));
  if (drag.most > 0) forces.push_back(drag.map ? drag_force(*drag.map) : drag_force(drag.most));
  forces.insert(forces.end(), own.forces.begin(), own.forces.end());
  return forces;
}

/// Where a particle was when it last left the neighbourhood of such a place.
struct Anchor {
  Vec3 place;
  int step = 0;
};

/// What one piece of the particles reports of a step.
struct StepReport {
  double speed = 0;           // largest, mm/s
  double voxels_squared = 0;  // largest displacement by the field
  bool finite = true;
};

/// A run of any model. Particles that still move are kept packed: with the free model, a stopped one costs nothing.
class Run {
 public:
  Run(const TriMesh& start, const VectorField& field, const Image& border, const Evolution& options,
      const BorderPlanes* planes, const Additions& own)
      : options_(options),
        own_(own),
        grid_(field.grid),
        smallest_spacing_(field.grid.spacing.minCoeff()),
        room_(room_of(field.grid, start)),
        pull_(checked_pull(field)),
        drag_(drag_of(field, border, options, own)),
        coupled_(couple(start, field)),
        plan_(make_plan(options, start.vertices.size(), pull_, drag_.least, stable_step_s(start.vertices.size()),
                        coupled_.has_value(), room_, smallest_spacing_)),
        motion_(free_motion(field, options.force, plan_.mass_kg, drag_.map ? &*drag_.map : nullptr)),
        path_(border),
        planes_(planes),
        rings_(vertex_rings(start)) {
    const std::size_t n = start.vertices.size();
    result_.mesh = start;
    result_.step_s = plan_.step_s;
    result_.stopped.assign(n, 0);
    state_.assign(6 * n, 0.0);
    before_.resize(n);
    hit_.resize(n);
    for (const Vec3& p : start.vertices) anchor_.push_back({p, 0});
    moving_.resize(n);
    for (std::uint32_t v = 0; v < n; ++v) {
      moving_[v] = v;
      for (std::size_t a = 0; a < 3; ++a) state_[6 * v + a] = start.vertices[v][static_cast<Eigen::Index>(a)];
    }
    if (options.histories) {
      to_border_.emplace(border);
      bucket_.assign(n, 3);
    }
  }

  EvolutionResult operator()(const Progress& progress) {
    note_step();
    result_.reason = StopReason::max_steps;
    int rested_steps = 0;
    while (result_.steps < options_.end.max_steps) {
      if (result_.steps % kStepsBetweenChecks == 0) progress.check();
      if (result_.steps % kStepsBetweenLimits == 0) keep_step_stable();
      if (!move()) {
        result_.reason = StopReason::diverged;
        break;
      }
      ++result_.steps;
      retire_stopped();
      if (options_.smooth_every > 0 && result_.steps % options_.smooth_every == 0) {
        smooth(result_.mesh.vertices, rings_, moving_, options_.smooth_during, smallest_spacing_);
        follow_smoothing();
        retire_stopped();
      }
      if (options_.histories) record_distances();
      if (moving_.empty()) {
        result_.reason = StopReason::all_stopped;
        break;
      }
      const auto all = static_cast<double>(result_.stopped.size());
      rested_steps = static_cast<double>(count_at_rest()) >= options_.end.still_share * all ? rested_steps + 1 : 0;
      if (rested_steps >= options_.end.still_steps) {
        result_.reason = StopReason::at_rest;
        break;
      }
    }
    return finish();
  }

 private:
  static double checked_pull(const VectorField& field) {
    const double pull = largest_pull(field);
    if (!std::isfinite(pull)) throw InputError("evolve: the field has a vector that is not finite");
    return pull;
  }

  std::optional<CoupledMotion> couple(const TriMesh& start, const VectorField& field) const {
    if (!needs_coupling(options_, own_)) return std::nullopt;
    return CoupledMotion(start, options_.mass_kg, all_forces(start, field, drag_, options_, own_), options_.solver);
  }

  /// Shortens an automatic step that the mesh has outgrown.
  void keep_step_stable() {
    if (!coupled_ || options_.step_s > 0 || !std::isfinite(plan_.limit_s)) return;
    const double longest = kShareOfLimit * coupled_->limit(drag_.least).step_s;
    if (longest >= plan_.step_s || !(longest > 0)) return;
    plan_.rest_mm *= longest / plan_.step_s;
    plan_.stray_steps = static_cast<int>(std::min(plan_.stray_mm / plan_.rest_mm, 1e9));
    plan_.step_s = result_.step_s = longest;
  }

  double stable_step_s(std::size_t particles) {
    if (coupled_) return coupled_->limit(drag_.least).step_s;
    return step_limit_s(options_.solver, options_.mass_kg, particles, drag_.most);
  }

  /// One step of the solver for all moving particles, and STOP-VOXEL on their paths. False, with the mesh as it was
  /// before, when the motion blew up.
  bool move() {
    if (coupled_) coupled_->step(result_.mesh.vertices, moving_, state_, plan_.step_s);
    reports_.assign((moving_.size() + kGrain - 1) / kGrain, {});
    parallel_for(moving_.size(), kGrain, [this](std::size_t begin, std::size_t end) {
      StepReport& report = reports_[begin / kGrain];
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
    if (!coupled_) advance(options_.solver, state, plan_.step_s, motion_, scratch);
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

  /// Moves `to` where the caller's stop or STOP-VOXEL, whichever comes first, holds a particle on its way from `from`;
  /// 1 when one does, else 0.
  template <class Point>
  std::uint8_t stop_on_path(const Vec3& step_begin, const Vec3& from, Point& to) const {
    std::uint8_t stopped = 0;
    if (own_.stop) {
      if (const std::optional<Vec3> point = own_.stop(from, to)) {
        to = *point;
        stopped = 1;
      }
    }
    if (!options_.stop.enabled) return stopped;
    const std::optional<BorderHit> hit = path_.first_hit(from, to);
    if (!hit) return stopped;
    switch (options_.stop.point) {
      case StopPoint::entry:
        to = hit->entry;
        break;
      case StopPoint::centre:
        to = centre_of(grid_, hit->voxel);
        break;
      case StopPoint::backtrack:
        to = step_begin;
        break;
      case StopPoint::subvoxel:
        to = meeting_point(grid_, planes_, *hit, to - from);
        break;
    }
    return 1;
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
        if (options_.histories) newly_stopped_.push_back(v);
        continue;
      }
      if (kept != s) {
        moving_[kept] = v;
        before_[kept] = before_[s];
        anchor_[kept] = anchor_[s];
        std::copy_n(&state_[6 * s], 6, &state_[6 * kept]);
      }
      ++kept;
    }
    moving_.resize(kept);
  }

  /// Stopped particles are at rest, too.
  std::size_t count_at_rest() {
    std::size_t count = result_.stopped.size() - moving_.size();
    for (std::size_t s = 0; s < moving_.size(); ++s) {
      const Vec3& position = result_.mesh.vertices[moving_[s]];
      if ((position - anchor_[s].place).squaredNorm() > plan_.stray_mm * plan_.stray_mm)
        anchor_[s] = {position, result_.steps};
      const bool is_slow = (position - before_[s]).squaredNorm() < plan_.rest_mm * plan_.rest_mm;
      if (is_slow || (plan_.stray_steps > 0 && result_.steps - anchor_[s].step >= plan_.stray_steps)) ++count;
    }
    return count;
  }

  void record_distances() {
    const auto bucket_of = [&](std::uint32_t v) {
      const double d = to_border_->voxels(result_.mesh.vertices[v], 3);
      return static_cast<std::uint8_t>(d < 3 ? static_cast<int>(d) : 3);
    };
    for (const std::uint32_t v : newly_stopped_) bucket_[v] = bucket_of(v);
    newly_stopped_.clear();
    for (const std::uint32_t v : moving_) bucket_[v] = bucket_of(v);
    std::array<int, 4> count{};
    for (const std::uint8_t b : bucket_) ++count[b];
    // "Nearer than 2" includes those nearer than 1.
    result_.histories.push_back({count[0], count[0] + count[1], count[0] + count[1] + count[2], count[3]});
  }

  EvolutionResult finish() {
    const auto stopped = std::count(result_.stopped.begin(), result_.stopped.end(), std::uint8_t{1});
    result_.stopped_fraction = static_cast<double>(stopped) / static_cast<double>(result_.stopped.size());
    note_fast_particle();
    if (coupled_ && coupled_->unsolved_steps() > 0)
      note(Severity::warning, "evolve.unsolved_steps", [&](auto& text) {
        text << "the linear system was not solved to the tolerance in " << coupled_->unsolved_steps() << " of "
             << result_.steps << " steps";
      });
    if (result_.reason == StopReason::diverged) {
      note(Severity::failure, "evolve.diverged", [&](auto& text) {
        text << "the motion blew up after " << result_.steps << " steps; a shorter step is needed";
      });
    } else {
      smooth(result_.mesh, options_.smooth_after, smallest_spacing_);
    }
    return std::move(result_);
  }

  void note_step() {
    if (plan_.step_s > plan_.limit_s)
      note(Severity::warning, "evolve.step_above_limit", [&](auto& text) {
        text << "the time step " << plan_.step_s << " s is above the stable limit " << plan_.limit_s << " s";
      });
    result_.step_explained = explained_step();
    // Where the drag alone bounds the step, it is that of table 4.2; other limits are worth a remark.
    if (coupled_ && options_.step_s <= 0)
      note(Severity::info, "evolve.step_chosen",
           [&](auto& text) { text << "the time step is " << plan_.step_s << " s: " << result_.step_explained; });
  }

  /// ODE-LIMIT in words.
  std::string explained_step() {
    std::ostringstream text;
    if (options_.step_s > 0) {
      text << "given";
      if (std::isfinite(plan_.limit_s)) text << "; stable are up to " << plan_.limit_s << " s";
    } else if (plan_.step_s < kShareOfLimit * plan_.limit_s) {
      text << "the field moves no particle more than " << kVoxelsPerStep << " voxels in it";
      if (std::isfinite(plan_.limit_s))
        text << "; stable are up to " << plan_.limit_s << " s";
      else
        text << "; the solver itself sets no limit";
    } else {
      text << kShareOfLimit << " of the largest stable one, " << plan_.limit_s << " s, set by ";
      if (coupled_) {
        const Fastest modes = coupled_->limit(drag_.least).modes;
        if (modes.stiffness > 0) text << "the stiffest motion (" << std::sqrt(modes.stiffness) << " rad/s) and ";
        text << "the strongest damping (" << modes.damping << " 1/s)";
      } else {
        text << "the drag of " << drag_.most << " kg/s on particles of " << plan_.mass_kg << " kg";
      }
    }
    return text.str();
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
    std::ostringstream text;
    write(text);
    result_.notes.push_back({severity, code, text.str()});
  }

  const Evolution& options_;
  const Additions& own_;
  const Grid grid_;
  const double smallest_spacing_;
  const Room room_;
  const double pull_;
  const Drag drag_;
  std::optional<CoupledMotion> coupled_;
  Plan plan_;
  const Derivative motion_;
  const BorderPath path_;
  const BorderPlanes* const planes_;
  const VertexRings rings_;
  std::optional<BorderDistance> to_border_;
  EvolutionResult result_;

  std::vector<std::uint32_t> moving_;  // vertices that move, ascending; the arrays below are parallel to it
  std::vector<double> state_;          // x, y, z, vx, vy, vz
  std::vector<Vec3> before_;           // positions before the step
  std::vector<Anchor> anchor_;
  std::vector<std::uint8_t> hit_;  // met the border in this step
  std::vector<StepReport> reports_;
  std::vector<std::uint32_t> newly_stopped_;
  std::vector<std::uint8_t> bucket_;  // whole voxels from the border, at most 3; per vertex
  double fastest_step_squared_ = 0;
  int fastest_step_ = 0;
};

}  // namespace

std::span<const std::string_view> names_of(StopPoint) { return kStopPoints; }
std::string_view name_of(StopReason reason) { return kStopReasons[static_cast<std::size_t>(reason)]; }

EvolutionResult evolve(const TriMesh& start, const VectorField& field, const Image& border, const Evolution& options,
                       const Progress& progress, const BorderPlanes* planes, const Additions& own) {
  Evolution checked = options;
  check_options(checked, "evolve");
  check_inputs(start, field, border);
  if (planes != nullptr &&
      (planes->offset.grid.dims != border.grid.dims || planes->normal.grid.dims != border.grid.dims))
    throw InputError("evolve: the border's planes lie on another grid than the border; expected the same size");
  check_additions(own, field);
  return Run(start, field, border, checked, planes, own)(progress);
}

}  // namespace dynasurf
