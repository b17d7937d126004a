#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "dynasurf/core/study.hpp"
#include "dynasurf/io/detail/byte_source.hpp"

namespace dynasurf::io {

enum class SampleType { uint8, int8, uint16, int16, uint32, int32, uint64, int64, float32, float64 };
std::size_t bytes_of(SampleType type);

/// How the voxels of a raw block are stored.
struct SampleLayout {
  SampleType type = SampleType::float32;
  bool big_endian = false;
  bool gate_fastest = false;  // the gates of one voxel follow each other; else whole volumes do
  double slope = 1, intercept = 0;
};

/// Throws InputError unless every extent is at least 1 and the study fits `max_study_bytes`. `where` names the file.
void check_study_size(std::uint64_t nx, std::uint64_t ny, std::uint64_t nz, std::uint64_t gates,
                      const std::string& where);

/// Memory that a study takes through the heaviest job on it, bytes.
std::uint64_t memory_of_study(std::uint64_t voxels, std::uint64_t gates);
/// Throws InputError when that is above the limit of memory. To be called before any voxel is read.
void require_memory_of_study(const Grid& grid, int gates, const std::string& where);

/// Reads `gates` volumes on `grid` and nothing more: the source must end there. Throws InputError for less or more
/// data than that, for more than the limit of memory allows, or for values that are not finite numbers (see
/// `fill_outside_field`, which adds to `notes`).
std::vector<Image> read_samples(ByteSource& source, const Grid& grid, int gates, const SampleLayout& layout,
                                const std::string& where, Notes& notes);

/// A grid from the world vectors (LPS mm) of one step along i, j and k. Throws InputError when they are not finite, of
/// no length, or sheared by more than rounding explains.
Grid grid_from_steps(const Index3& dims, const Mat3& steps, const Vec3& origin, const std::string& where);

}  // namespace dynasurf::io
