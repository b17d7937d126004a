#pragma once
#include <span>
#include <vector>

#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/field/vector_field.hpp"
#include "dynasurf/show/detail/inputs.hpp"
#include "dynasurf/show/detail/pictures.hpp"

namespace dynasurf::show {

/// The motion of a wall once more, with its mesh at some steps.
struct Motion {
  dynamics::EvolutionResult result;
  std::vector<EvolutionFrame> frames;
};

/// Where the border runs inside its voxels is not kept: particles that would meet it there (stop.point subvoxel) stop
/// at the centres. No particle of a frame counts as stopped. Precondition: the wall has a start.
Motion move_again(const ShownWall& wall, const field::VectorField& field, const dynamics::Evolution& evolution,
                  std::span<const int> steps, const Progress& progress);

/// The motion without smoothing at its end, at the steps that are asked for, or at `count` of them, closer together at
/// the beginning. A particle has stopped where it lies where it lies at the end. Throws OptionError for a step that the
/// run does not reach.
Motion move_in_frames(const ShownWall& wall, const field::VectorField& field, dynamics::Evolution evolution,
                      std::vector<int> steps, int count, const Progress& progress);

/// The ways of the particles that end within half a slice of slice k, in voxels: a point whenever one has moved on by a
/// quarter of a voxel.
std::vector<std::vector<Vec2>> paths_in(const ShownWall& wall, const field::VectorField& field,
                                        const dynamics::Evolution& evolution, int k, const Progress& progress);

}  // namespace dynasurf::show
