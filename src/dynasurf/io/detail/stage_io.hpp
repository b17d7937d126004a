#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::io {

// What a run passed through, as files that ParaView (.vti) and 3D Slicer (.nrrd) open. Both stand in the world, LPS mm,
// with the grid's direction, so that meshes written by `write_mesh` lie where they belong. Each file appears whole or
// not at all.

/// The components of a vector per voxel along the grid's own axes, as VectorField holds them. In the file they are
/// turned to the axes of the world, which is where both programs draw arrows.
using VectorSpans = std::array<std::span<const float>, 3>;

/// One named value, or vector, per voxel in the order of Volume.
struct VoxelArray {
  std::string name;
  std::variant<std::span<const float>, std::span<const std::uint8_t>, VectorSpans> values;
};

/// VTK ImageData: every array as point data, points at the centres of the voxels.
/// Throws InputError for an array of another size than the grid or a grid without voxels, IoError.
void write_vti(const Grid& grid, std::span<const VoxelArray> arrays, const std::filesystem::path& path);

/// NRRD, attached and raw; vectors as a first axis of kind vector. Throws as `write_vti`.
void write_nrrd_volume(const Image& volume, const std::filesystem::path& path);
void write_nrrd_volume(const Mask& volume, const std::filesystem::path& path);
void write_nrrd_vectors(const Grid& grid, const VectorSpans& vectors, const std::filesystem::path& path);

}  // namespace dynasurf::io
