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
#include "dynasurf/dynamics/detail/border_planes.hpp"
#include "dynasurf/dynamics/detail/damping.hpp"
#include "dynasurf/dynamics/detail/models.hpp"
#include "dynasurf/dynamics/options.hpp"
#include "dynasurf/dynamics/solvers/detail/solver_options.hpp"
#include "dynasurf/field/detail/field_view.hpp"
#include "dynasurf/mesh/smooth.hpp"

namespace dynasurf::dynamics {

/// Where the particles were after a step, and the field's force on each there, N (0 once it stopped).
struct TrajectoryStep {
  int step = 0;
  std::vector<Vec3> places, pulls;    // grid frame
  std::vector<std::uint8_t> stopped;  // per particle: reached a border voxel
};

/// Where a deformable model came to rest, and how it came there.
struct EvolutionResult {
  TriMesh mesh;  // grid frame
  StopReason reason = StopReason::max_steps;
  int steps = 0;
  double step_s = 0;                  // time step used; the last and shortest one, where it had to be shortened
  std::string step_explained;         // what set the first one, in words: the user, stability, or the field's speed
  std::vector<std::uint8_t> stopped;  // per vertex: reached a border voxel
  double stopped_fraction = 0;
  std::vector<std::array<int, 4>> histories;  // per step: particles < 1, < 2, < 3 (each with the former), >= 3 voxels
  std::vector<TrajectoryStep> trajectory;     // with `trajectory_every`: the start, every so many steps, and the last
  Notes notes;  // "evolve.step_chosen", ".step_above_limit", ".fast_particle", ".unsolved_steps", ".max_steps",
                // ".diverged"
};

/// What a caller adds to a run of his own.
struct Additions {
  /// Act next to those of the model. Without a jacobian, implicit solvers take a force as constant within a step.
  std::vector<Force> forces = {};
  OwnStop stop = {};
  /// On the grid of the border; tells StopPoint::subvoxel where in its voxels the border runs. Null: at their centres.
  const BorderPlanes* planes = nullptr;
  /// Drag of every voxel in kg/s, on the field's grid, in place of `Evolution::damping` (see drag_by_intensity).
  std::optional<Image> drag = {};
  /// Called after every step with the number of steps and the mesh as it stands, from the thread that called.
  std::function<void(int steps, const TriMesh& mesh)> watch = {};
};

/// Moves the vertices of `start` (grid frame) under `field`, a `VectorField` or a `BandField`, until they rest on the
/// non-zero voxels of `border`. Particles start at rest. They cannot leave the box that holds the grid's cells and the
/// start. With `stop` on, neither the field nor the smoothing takes a particle through a border voxel, however long the
/// step. Deterministic for any thread count. On divergence the mesh before the bad step is returned, with the reason.
/// Throws InputError for an empty or far start, a field that is not finite, or a border or planes on another grid.
EvolutionResult evolve(const TriMesh& start, field::FieldView field, const Image& border, const Evolution& options,
                       const Progress& progress = {}, const Additions& own = {});

}  // namespace dynasurf::dynamics
