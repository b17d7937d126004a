#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/progress.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/dynamics/detail/damping.hpp"
#include "dynasurf/dynamics/detail/models.hpp"
#include "dynasurf/dynamics/solvers/detail/solver_options.hpp"
#include "dynasurf/field/detail/field_view.hpp"
#include "dynasurf/mesh/smooth.hpp"

namespace dynasurf::dynamics {

/// The field's pull and the drag on each particle: F = strength * V(x) - drag * v (thesis 3.4).
struct FieldForce {
  double strength = 10;
  double drag = 0.1;
  field::Sampling sampling = field::Sampling::nearest;
};
void describe(auto& visit, FieldForce& o) {
  visit("strength", o.strength, OptionInfo{"K_GVF: pull of the field", "N mm", 0, 1e9});
  visit("drag", o.drag, OptionInfo{"k_d: force against the velocity", "kg/s", 0, 1e9});
  visit("sampling", o.sampling, OptionInfo{"how the field is read between voxel centres"});
}

/// Where on its path a particle stops when it meets a border voxel (STOP-VOXEL, thesis 6.1.2.3).
enum class StopPoint { entry, centre, backtrack, subvoxel };
std::span<const std::string_view> names_of(StopPoint);

/// Whether and where particles stop at their border.
struct StopVoxel {
  bool enabled = true;
  StopPoint point = StopPoint::entry;
};
void describe(auto& visit, StopVoxel& o) {
  visit("enabled", o.enabled, OptionInfo{"particles stop for good in voxels of their border"});
  visit("point", o.point,
        OptionInfo{"entry: where the path meets the voxel (thesis); centre: the voxel's centre; backtrack: last point "
                   "before it; subvoxel: where the path meets the border inside the voxel"});
}

/// When the whole run ends (STOP-CONV, O16). In steps shorter than the automatic one, a particle must be slower in
/// proportion to be at rest. `still_radius` is ours: field and smoothing may pull a particle to and fro for ever.
struct StopConv {
  double still_share = 0.99;
  double still_move = 1e-3;
  double still_radius = 0.1;
  int still_steps = 10;
  int max_steps = 5000;
};
void describe(auto& visit, StopConv& o) {
  visit("still_share", o.still_share, OptionInfo{"share of particles that must be at rest", "", 0, 1});
  visit("still_move", o.still_move,
        OptionInfo{"a particle that moves less per step rests", "of the smallest voxel side", 0, 1});
  visit("still_radius", o.still_radius,
        OptionInfo{
            "one that strays no farther in as many steps as it takes at still_move rests, too, as does one that strays "
            "2, 4, 8 times as far in as many times as long; 0: they do not",
            "of the smallest voxel side", 0, 1000});
  visit("still_steps", o.still_steps, OptionInfo{"steps in a row", "", 1, 100000});
  visit(
      "max_steps", o.max_steps,
      OptionInfo{"the run ends here in any case; steps that a solver cuts its own into count half", "", 1, 100000000});
}

/// How a mesh is deformed: a model, a field, a stop, and smoothing. The default is the free model (MOD-FREE, thesis
/// 3.4.5); the others come from the functions at the end.
struct Evolution {
  ModelOptions model = FreeModel{};
  SolverOptions solver = AutomaticSolver{};
  double step_s = 0;
  double mass_kg = 1;
  FieldForce force;
  DampingOptions damping = UniformDrag{};
  StopVoxel stop;
  StopConv end;
  int smooth_every = 1;
  mesh::Smoothing smooth_during;
  mesh::Smoothing smooth_after;
  bool histories = false;
  int trajectory_every = 0;
};
void describe(auto& visit, Evolution& o) {
  visit("model", o.model, OptionInfo{"what the particles know of each other"});
  visit("solver", o.solver,
        OptionInfo{"how the motion is integrated; automatic: rk4 for the free model, backward_euler for the others"});
  visit("step_s", o.step_s,
        OptionInfo{"time step; 0: 0.8 of the largest stable one, less where particles could move 0.3 voxels in it", "s",
                   0, 1e3});
  visit("mass_kg", o.mass_kg, OptionInfo{"mass of the whole mesh, shared equally", "kg", 1e-9, 1e9});
  visit("force", o.force, OptionInfo{"force on each particle"});
  visit("damping", o.damping, OptionInfo{"where the drag is raised"});
  visit("stop", o.stop, OptionInfo{"stop in border voxels"});
  visit("end", o.end, OptionInfo{"end of the run"});
  visit("smooth_every", o.smooth_every,
        OptionInfo{"smooth moving particles every so many steps; 0 never", "steps", 0, 1000000});
  visit("smooth_during", o.smooth_during, OptionInfo{"smoothing while moving"});
  visit("smooth_after", o.smooth_after, OptionInfo{"smoothing of the final mesh; stopped particles move too"});
  visit("trajectory_every", o.trajectory_every,
        OptionInfo{
            "with the stages kept: where every particle is and how the field pulls it, every so many steps; 0: not",
            "steps", 0, 1000000});
}

/// Why an evolution ended: every particle reached a border voxel; none moves any more; no steps left; a position
/// became infinite.
enum class StopReason { all_stopped, at_rest, max_steps, diverged };
/// The word for it, as it stands in files.
std::string_view name_of(StopReason);

/// Where a particle on its way between two points (grid frame) stops for good; nothing: it goes on. Asked before the
/// border, from several threads at once.
using OwnStop = std::function<std::optional<Vec3>(const Vec3& from, const Vec3& to)>;

/// The models of the thesis as options, with the solver that suits them (`solver_for`). The free one is smoothed on the
/// way, the others are not: internal forces keep them in order.
Evolution free_model();
Evolution spring_model();
Evolution restricted_spring_model();
Evolution plain_model();
Evolution curvature_model();

}  // namespace dynasurf::dynamics
