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
#include "dynasurf/dynamics/border_planes.hpp"
#include "dynasurf/dynamics/damping.hpp"
#include "dynasurf/dynamics/models.hpp"
#include "dynasurf/dynamics/solvers/solver_options.hpp"
#include "dynasurf/field/field_view.hpp"
#include "dynasurf/mesh/smooth.hpp"

namespace dynasurf {

/// The field's pull and the drag on each particle: F = strength * V(x) - drag * v (thesis 3.4).
struct FieldForce {
  double strength = 10;
  double drag = 0.1;
  Sampling sampling = Sampling::nearest;
};
void describe(auto& visit, FieldForce& o) {
  visit("strength", o.strength, Field{"K_GVF: pull of the field", "N mm", 0, 1e9});
  visit("drag", o.drag, Field{"k_d: force against the velocity", "kg/s", 0, 1e9});
  visit("sampling", o.sampling, Field{"how the field is read between voxel centres"});
}

/// Where on its path a particle stops when it meets a border voxel (STOP-VOXEL, thesis 6.1.2.3).
enum class StopPoint { entry, centre, backtrack, subvoxel };
std::span<const std::string_view> names_of(StopPoint);

struct StopVoxel {
  bool enabled = true;
  StopPoint point = StopPoint::entry;
};
void describe(auto& visit, StopVoxel& o) {
  visit("enabled", o.enabled, Field{"particles stop for good in voxels of their border"});
  visit("point", o.point,
        Field{"entry: where the path meets the voxel (thesis); centre: the voxel's centre; backtrack: last point "
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
  visit("still_share", o.still_share, Field{"share of particles that must be at rest", "", 0, 1});
  visit("still_move", o.still_move,
        Field{"a particle that moves less per step rests", "of the smallest voxel side", 0, 1});
  visit(
      "still_radius", o.still_radius,
      Field{"one that strays no farther in as many steps as it takes at still_move rests, too, as does one that strays "
            "2, 4, 8 times as far in as many times as long; 0: they do not",
            "of the smallest voxel side", 0, 1000});
  visit("still_steps", o.still_steps, Field{"steps in a row", "", 1, 100000});
  visit("max_steps", o.max_steps,
        Field{"the run ends here in any case; steps that a solver cuts its own into count half", "", 1, 100000000});
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
  Smoothing smooth_during;
  Smoothing smooth_after;
  bool histories = false;
};
void describe(auto& visit, Evolution& o) {
  visit("model", o.model, Field{"what the particles know of each other"});
  visit("solver", o.solver,
        Field{"how the motion is integrated; automatic: rk4 for the free model, backward_euler for the others"});
  visit("step_s", o.step_s,
        Field{"time step; 0: 0.8 of the largest stable one, less where particles could move 0.3 voxels in it", "s", 0,
              1e3});
  visit("mass_kg", o.mass_kg, Field{"mass of the whole mesh, shared equally", "kg", 1e-9, 1e9});
  visit("force", o.force, Field{"force on each particle"});
  visit("damping", o.damping, Field{"where the drag is raised"});
  visit("stop", o.stop, Field{"stop in border voxels"});
  visit("end", o.end, Field{"end of the run"});
  visit("smooth_every", o.smooth_every,
        Field{"smooth moving particles every so many steps; 0 never", "steps", 0, 1000000});
  visit("smooth_during", o.smooth_during, Field{"smoothing while moving"});
  visit("smooth_after", o.smooth_after, Field{"smoothing of the final mesh; stopped particles move too"});
  visit("histories", o.histories, Field{"keep how many particles are within 1, 2, 3 voxels of the border, per step"});
}

enum class StopReason { all_stopped, at_rest, max_steps, diverged };
std::string_view name_of(StopReason);

struct EvolutionResult {
  TriMesh mesh;  // grid frame
  StopReason reason = StopReason::max_steps;
  int steps = 0;
  double step_s = 0;                  // time step used; the last and shortest one, where it had to be shortened
  std::string step_explained;         // what set the first one, in words: the user, stability, or the field's speed
  std::vector<std::uint8_t> stopped;  // per vertex: reached a border voxel
  double stopped_fraction = 0;
  std::vector<std::array<int, 4>> histories;  // per step: particles < 1, < 2, < 3 (each with the former), >= 3 voxels
  Notes notes;  // "evolve.step_chosen", ".step_above_limit", ".fast_particle", ".unsolved_steps", ".max_steps",
                // ".diverged"
};

/// Where a particle on its way between two points (grid frame) stops for good; nothing: it goes on. Asked before the
/// border, from several threads at once.
using OwnStop = std::function<std::optional<Vec3>(const Vec3& from, const Vec3& to)>;

/// What a caller adds to a run of his own.
struct Additions {
  /// Act next to those of the model. Without a jacobian, implicit solvers take a force as constant within a step.
  std::vector<Force> forces = {};
  OwnStop stop = {};
  /// Drag of every voxel in kg/s, on the field's grid, in place of `Evolution::damping` (see drag_by_intensity).
  std::optional<Image> drag = {};
};

/// Moves the vertices of `start` (grid frame) under `field`, a `VectorField` or a `BandField`, until they rest on the
/// non-zero voxels of `border`. Particles start at rest. They cannot leave the box that holds the grid's cells and the
/// start. With `stop` on, neither the field nor the smoothing takes a particle through a border voxel, however long the
/// step. Deterministic for any thread count. On divergence the mesh before the bad step is returned, with the reason.
/// Throws InputError for an empty or far start, a field that is not finite, or a border on another grid. `planes`, on
/// the grid of `border`, tells StopPoint::subvoxel where in its voxels the border runs; without it the voxels' centres
/// are taken.
EvolutionResult evolve(const TriMesh& start, FieldView field, const Image& border, const Evolution& options,
                       const Progress& progress = {}, const BorderPlanes* planes = nullptr, const Additions& own = {});

/// The models of the thesis as options, with the solver that suits them (`solver_for`). The free one is smoothed on the
/// way, the others are not: internal forces keep them in order.
Evolution free_model();
Evolution spring_model();
Evolution restricted_spring_model();
Evolution plain_model();
Evolution curvature_model();

}  // namespace dynasurf
