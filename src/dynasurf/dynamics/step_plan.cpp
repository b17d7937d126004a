#include "dynasurf/dynamics/detail/step_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dynasurf/core/detail/text_stream.hpp"

namespace dynasurf::dynamics {
namespace {

constexpr double kShareOfLimit = 0.8;   // of the largest stable step
constexpr double kVoxelsPerStep = 0.3;  // the automatic step keeps the steady speed below this
constexpr double kRunaway = 100;        // times the fastest speed the field can give

int steps_to_cross(double way_mm, double per_step_mm) { return std::min(way_mm / per_step_mm, 1e9); }

/// Falling all through the room, or the steady speed at which the drag balances the field.
double fastest_mm_s(double force, double particle_kg, double drag, const Room& room) {
  const double falling = std::sqrt(2 * force / particle_kg * room.diagonal_mm());
  return drag > 0 ? std::min(falling, force / drag) : falling;
}

}  // namespace

Room room_of(const Grid& grid, const TriMesh& start) {
  Room room{-grid.spacing / 2, Vec3(grid.dims[0] - 0.5, grid.dims[1] - 0.5, grid.dims[2] - 0.5)};
  room.high = room.high.cwiseProduct(grid.spacing);
  for (const Vec3& p : start.vertices) {
    room.low = room.low.cwiseMin(p);
    room.high = room.high.cwiseMax(p);
  }
  return room;
}

bool StepPlan::is_bounded_by_stability() const { return step_s >= longest_stable_s(limit_s); }

void StepPlan::shorten(double new_limit_s) {
  const double shorter_s = longest_stable_s(new_limit_s);
  rest_mm *= shorter_s / step_s;
  stray_steps = steps_to_cross(stray_mm, rest_mm);
  step_s = shorter_s;
  limit_s = new_limit_s;
}

StepPlan plan_steps(const Evolution& o, std::size_t particles, const Pace& pace, const Room& room,
                    double smallest_spacing_mm) {
  StepPlan plan;
  plan.mass_kg = o.mass_kg / particles;
  plan.fastest = fastest_mm_s(o.force.strength * pace.pull, plan.mass_kg, pace.least_drag, room);
  plan.limit_s = pace.limit_s;
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
  if (pace.is_coupled) plan.runaway = std::max(plan.runaway, room.diagonal_mm() / plan.step_s);
  // In a shorter step a particle covers less ground without being nearer to rest. Internal forces may need a step so
  // short that it tells nothing of the speed of the field: there, the field's own step is the measure.
  const double usual_s = pace.is_coupled && std::isfinite(by_speed) ? by_speed : plan.automatic_s;
  plan.rest_mm = o.end.still_move * smallest_spacing_mm * std::min(1.0, plan.step_s / usual_s);
  plan.stray_mm = o.end.still_radius * smallest_spacing_mm;
  plan.stray_steps = steps_to_cross(plan.stray_mm, plan.rest_mm);
  // Nor have particles that begin without speed gained any in a few shorter steps: nobody rests before moving in the
  // time of the usual ones.
  plan.start_steps = std::min(o.end.still_steps * std::max(0.0, usual_s / plan.step_s - 1), 1e9);
  return plan;
}

double speed_unit(double least_drag, double particle_kg) { return std::max(1.0, least_drag / particle_kg); }

double longest_stable_s(double limit_s) { return kShareOfLimit * limit_s; }

std::string explain_step(const StepPlan& plan, bool is_given, const std::string& limit_in_words) {
  TextOutput text;
  const bool is_bounded = std::isfinite(plan.limit_s);
  if (is_given) {
    text << "given";
    if (is_bounded) text << "; stable are up to " << plan.limit_s << " s";
  } else if (!plan.is_bounded_by_stability()) {
    text << "the field moves no particle more than " << kVoxelsPerStep << " voxels in it";
    if (is_bounded)
      text << "; stable are up to " << plan.limit_s << " s";
    else
      text << "; the solver itself sets no limit";
  } else {
    text << kShareOfLimit << " of the largest stable one, " << plan.limit_s << " s, set by " << limit_in_words;
  }
  return text.str();
}

}  // namespace dynasurf::dynamics
