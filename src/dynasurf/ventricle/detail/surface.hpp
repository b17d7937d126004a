#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dynasurf/core/progress.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/heart/base_plane.hpp"
#include "dynasurf/mesh/contour_stack.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/repair.hpp"
#include "dynasurf/ventricle/detail/contour_pipeline.hpp"

namespace dynasurf::ventricle {

/// How the particles of a surface came to rest, world frame, and what they moved in.
struct Motion {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<dynamics::TrajectoryStep> steps;
  /// Per step and particle: voxels from the nearest centre of a border voxel, negative inside (MEAS-DIST).
  std::vector<std::vector<double>> distances;
  Image border;               // above 0: voxels of the border
  field::VectorField field;   // that pulled them, on the border's grid
  std::optional<Image> drag;  // kg/s per voxel, where it is not the same everywhere
};

/// One surface of one gate. `mesh` is in the world frame.
struct Surface {
  TriMesh mesh;
  double volume_ml = 0;
  dynamics::StopReason stop_reason = dynamics::StopReason::max_steps;
  int steps = 0;
  double step_s = 0;            // the time step of its motion
  std::string step_explained;   // and what set it
  double stopped_fraction = 0;  // particles that reached their border
  double within_one_voxel = 0;  // share of particles closer than one voxel to a border voxel's centre (MEAS-DIST)
  double border_reached = 0;    // share of its border's voxels closer than one voxel to the surface
  double mean_distance_mm = 0;  // to the nearest centre of a border voxel
  mesh::TriangleQuality quality;
  mesh::Repair
      repair;   // what was done to make it publishable, and what it is: closed, manifold, free of self-intersections
  Notes notes;  // "surface.untangled", "surface.tangled"
  std::optional<mesh::StackVolumes> stack;  // pipeline contour: the volume in three ways, mm3
  std::optional<WallContours> contours;     // likewise, on the grid of the study
  std::optional<Motion> motion;             // with `evolution.trajectory_every`
};

/// What is published of an evolved mesh: `settled`, the same surface moved on (`settle_on_slope`), or the mesh itself
/// without it. The distances are those of the mesh as its particles came to rest, from the border it was made for.
/// Ill-shaped triangles are improved, and triangles that cut each other are freed, as `tidy` says (`repair_surface`).
/// With a valve plane (world frame) the surface ends there (`flatten_above`): volume, mesh and triangles are those of
/// the closed part below it.
Surface measure_surface(const dynamics::EvolutionResult& evolved, const Image& border,
                        const std::optional<heart::BasePlane>& base_plane = std::nullopt,
                        const mesh::Tidy& options = {}, const TriMesh* settled = nullptr);

}  // namespace dynasurf::ventricle
