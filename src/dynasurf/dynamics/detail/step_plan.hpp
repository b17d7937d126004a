#pragma once
#include <string>

#include "dynasurf/core/grid.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/dynamics/options.hpp"

namespace dynasurf::dynamics {

/// The room of the particles: the cells of the grid and the box of the start. Who starts outside the grid may come in
/// from there, but nobody can leave.
struct Room {
  Vec3 low, high;
  double diagonal_mm() const { return (high - low).norm(); }
};
Room room_of(const Grid& grid, const TriMesh& start);

/// What sets the pace of a run.
struct Pace {
  double pull = 0;        // the field's longest vector
  double least_drag = 0;  // anywhere, kg/s
  double limit_s = 0;     // the largest stable step of what moves the particles
  bool is_coupled = false;
};

/// What follows from the options before the first step.
struct StepPlan {
  double mass_kg = 0;  // of one particle
  double fastest = 0;  // bound of the speed that the field can give, mm/s
  double limit_s = 0, automatic_s = 0, step_s = 0;
  double runaway = 0;   // faster is a blow-up, mm/s
  double rest_mm = 0;   // who moves less in a step is at rest
  double stray_mm = 0;  // and who strays no farther in so many steps
  int stray_steps = 0;
  int start_steps = 0;  // who has not moved yet has only begun slowly: particles begin without speed

  /// Whether stability sets the automatic step, and not the speed of the particles.
  bool is_bounded_by_stability() const;
  /// Takes the longest step for a new, smaller limit; in it, a particle at rest covers less ground.
  void shorten(double new_limit_s);
};

/// The step that the user gave, or the automatic one (ODE-LIMIT): a share of the stable one, less where a particle as
/// fast as the field can make it would move too many voxels. Throws OptionError where no step is stable.
StepPlan plan_steps(const Evolution& options, std::size_t particles, const Pace& pace, const Room& room,
                    double smallest_spacing_mm);

/// In what errors of speeds count beside errors of places, 1/s: a speed that is wrong by this leads 1 mm astray before
/// the drag ends it. At least 1.
double speed_unit(double least_drag, double particle_kg);

/// The longest step that is taken where the largest stable one is `limit_s`.
double longest_stable_s(double limit_s);

/// What set the step, in words. `limit_in_words` tells what the stable step comes from.
std::string explain_step(const StepPlan& plan, bool is_given, const std::string& limit_in_words);

}  // namespace dynasurf::dynamics
