#include "dynasurf/io/detail/samples.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/study_mend.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::io {
namespace {

static_assert(std::endian::native == std::endian::little, "the readers swap bytes for a little-endian machine");

// Headers hold directions as rounded decimals or 32-bit floats. More than this (0.06 degrees) is a real shear.
constexpr double shear_tolerance = 1e-3;

template <class T>
void convert(const std::byte* in, std::size_t count, const SampleLayout& layout, float* out, std::size_t stride) {
  const bool scaled = layout.slope != 1 || layout.intercept != 0;
  for (std::size_t n = 0; n < count; ++n, in += sizeof(T), out += stride) {
    std::array<std::byte, sizeof(T)> raw;
    std::memcpy(raw.data(), in, sizeof(T));
    if (layout.big_endian) std::reverse(raw.begin(), raw.end());
    const T value = std::bit_cast<T>(raw);
    *out = scaled ? static_cast<float>(layout.slope * static_cast<double>(value) + layout.intercept)
                  : static_cast<float>(value);
  }
}

void convert_any(const std::byte* in, std::size_t count, const SampleLayout& layout, float* out, std::size_t stride) {
  switch (layout.type) {
    case SampleType::uint8:
      return convert<std::uint8_t>(in, count, layout, out, stride);
    case SampleType::int8:
      return convert<std::int8_t>(in, count, layout, out, stride);
    case SampleType::uint16:
      return convert<std::uint16_t>(in, count, layout, out, stride);
    case SampleType::int16:
      return convert<std::int16_t>(in, count, layout, out, stride);
    case SampleType::uint32:
      return convert<std::uint32_t>(in, count, layout, out, stride);
    case SampleType::int32:
      return convert<std::int32_t>(in, count, layout, out, stride);
    case SampleType::uint64:
      return convert<std::uint64_t>(in, count, layout, out, stride);
    case SampleType::int64:
      return convert<std::int64_t>(in, count, layout, out, stride);
    case SampleType::float32:
      return convert<float>(in, count, layout, out, stride);
    case SampleType::float64:
      return convert<double>(in, count, layout, out, stride);
  }
}

}  // namespace

std::size_t bytes_of(SampleType type) {
  switch (type) {
    case SampleType::uint8:
    case SampleType::int8:
      return 1;
    case SampleType::uint16:
    case SampleType::int16:
      return 2;
    case SampleType::uint32:
    case SampleType::int32:
    case SampleType::float32:
      return 4;
    default:
      return 8;
  }
}

// Peak memory of `ventricle` on two threads, measured with one heart at 1, 2 and 3 times the resolution and in a wider
// field: 54 MB (94,208 voxels, 1 gate), 157 MB (753,664, 1), 465 MB (2,543,616, 1), 133 MB (94,208, 8), 656 MB
// (753,664, 8). Images, edge maps and fields of every gate live together; the bound is 8 to 49 % above.
std::uint64_t memory_of_study(std::uint64_t voxels, std::uint64_t gates) {
  return (std::uint64_t{64} << 20) + gates * (std::uint64_t{4} << 20) + voxels * (70 + 100 * gates);
}

void check_study_size(std::uint64_t nx, std::uint64_t ny, std::uint64_t nz, std::uint64_t gates,
                      const std::string& where) {
  const std::string sizes = std::to_string(nx) + " x " + std::to_string(ny) + " x " + std::to_string(nz) +
                            " voxels x " + std::to_string(gates) + " gates";
  std::uint64_t room = max_study_bytes / sizeof(float);
  for (const std::uint64_t extent : {nx, ny, nz, gates}) {
    if (extent == 0) throw InputError(where + ": is empty: it declares " + sizes);
    room /= extent;  // floor division cannot hide an excess: floor(floor(r/a)/b) = floor(r/(ab))
  }
  if (room == 0)
    throw InputError(where + ": declares " + sizes + "; at most " + std::to_string(max_study_bytes >> 20) +
                     " MiB of 32-bit values are read");
}

void require_memory_of_study(const Grid& grid, int gates, const std::string& where) {
  require_memory(memory_of_study(grid.size(), gates), where,
                 std::to_string(grid.dims[0]) + " x " + std::to_string(grid.dims[1]) + " x " +
                     std::to_string(grid.dims[2]) + " voxels x " + std::to_string(gates) + " gates");
}

std::vector<Image> read_samples(ByteSource& source, const Grid& grid, int gates, const SampleLayout& layout,
                                const std::string& where, Notes& notes) {
  const std::size_t sample = bytes_of(layout.type), voxels = grid.size(), count = gates;
  const std::uint64_t declared = std::uint64_t{sample} * voxels * count;
  if (declared > source.most_bytes_left())
    throw InputError(where + ": is cut off: its header declares " + std::to_string(declared) +
                     " bytes of voxels, the file can hold at most " + std::to_string(source.most_bytes_left()));
  require_memory_of_study(grid, gates, where);

  std::vector<Image> images;
  std::vector<std::byte> block;
  // Plain volumes are taken one after the other, so that memory grows with what really arrives.
  const std::size_t together = layout.gate_fastest ? count : 1;
  const std::size_t per_block = std::max<std::size_t>(1, (std::size_t{1} << 16) / together);
  for (std::size_t first = 0; first < count; first += together) {
    for (std::size_t g = 0; g < together; ++g) images.emplace_back(grid);
    for (std::size_t v = 0; v < voxels; v += per_block) {
      const std::size_t n = std::min(per_block, voxels - v);
      block.resize(n * together * sample);
      source.read(block, "voxel data");
      for (std::size_t g = 0; g < together; ++g) {
        float* out = images[first + g].values.data() + v;
        if (together == 1)
          convert_any(block.data(), n, layout, out, 1);
        else
          for (std::size_t m = 0; m < n; ++m) convert_any(&block[(m * together + g) * sample], 1, layout, out + m, 1);
      }
    }
  }
  source.expect_end();
  fill_outside_field(images, where, notes);
  return images;
}

Grid grid_from_steps(const Index3& dims, const Mat3& steps, const Vec3& origin, const std::string& where) {
  if (!steps.allFinite() || !origin.allFinite())
    throw InputError(where + ": its position or orientation is not a finite number");
  Grid grid;
  grid.dims = dims;
  grid.origin = origin + Vec3::Zero();  // turns -0 into 0
  Mat3 unit;
  for (int axis = 0; axis < 3; ++axis) {
    grid.spacing[axis] = steps.col(axis).norm();
    if (!(grid.spacing[axis] > 1e-6) || !(grid.spacing[axis] < 1e6))
      throw InputError(where + ": voxel size along axis " + std::to_string(axis + 1) + " is " +
                       std::to_string(grid.spacing[axis]) + " mm; expected a plausible length");
    unit.col(axis) = steps.col(axis) / grid.spacing[axis];
  }
  const double shear = std::max({std::abs(unit.col(0).dot(unit.col(1))), std::abs(unit.col(0).dot(unit.col(2))),
                                 std::abs(unit.col(1).dot(unit.col(2)))});
  if (shear > shear_tolerance)
    throw InputError(where + ": its voxel axes are not at right angles (cosine " + std::to_string(shear) +
                     "); resample it to a straight grid first");
  // The rounding of the file is taken out, so that the direction is a rotation (or its mirror) to the last bit.
  grid.direction.col(0) = unit.col(0);
  grid.direction.col(1) = (unit.col(1) - unit.col(0) * unit.col(0).dot(unit.col(1))).normalized();
  const Vec3 normal = grid.direction.col(0).cross(grid.direction.col(1));
  grid.direction.col(2) = normal.dot(unit.col(2)) < 0 ? Vec3(-normal) : normal;
  grid.direction += Mat3::Zero();
  return grid;
}

}  // namespace dynasurf::io
