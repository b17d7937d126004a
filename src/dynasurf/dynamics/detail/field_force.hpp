#pragma once
#include "dynasurf/dynamics/options.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"

namespace dynasurf::dynamics {

/// The motion of free particles under a field force (SYS-PARTICLE, thesis 3.1-3.3): y holds x, y, z, vx, vy, vz of one
/// particle after another (mm, mm/s); x' = v, v' = (strength * V(x) - drag * v) / particle_mass_kg. With a map
/// of the drag (kg/s per voxel), its nearest voxel stands in for the drag. What `field` shows and the map must outlive
/// the result.
Derivative free_motion(field::FieldView field, const FieldForce& force, double particle_mass_kg,
                       const Image* drag_map = nullptr);

}  // namespace dynasurf::dynamics
