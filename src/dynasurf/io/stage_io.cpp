#include "dynasurf/io/detail/stage_io.hpp"

#include <string_view>
#include <type_traits>
#include <vector>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/vtk_xml.hpp"

namespace dynasurf::io {
namespace {

using detail::append_text;

void check_size(const Grid& grid, std::size_t values, const std::filesystem::path& path) {
  if (grid.dims[0] < 1 || grid.dims[1] < 1 || grid.dims[2] < 1)
    throw InputError("cannot write " + path.string() + ": the grid has no voxel");
  if (values != grid.size())
    throw InputError("cannot write " + path.string() + ": " + std::to_string(values) + " values for " +
                     std::to_string(grid.size()) + " voxels");
}

void check_size(const Grid& grid, const VectorSpans& vectors, const std::filesystem::path& path) {
  for (const auto& component : vectors) check_size(grid, component.size(), path);
}

/// x, y, z of voxel 0, then of voxel 1, along the axes of the world.
std::vector<float> in_world(const Grid& grid, const VectorSpans& vectors) {
  std::vector<float> out;
  out.reserve(3 * grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Vec3 world = grid.direction * Vec3(vectors[0][i], vectors[1][i], vectors[2][i]);
    for (const double c : world) out.push_back(c);
  }
  return out;
}

template <class Numbers>
std::string joined(const Numbers& numbers, std::string_view separator) {
  std::string out;
  for (const auto n : numbers) {
    if (!out.empty()) out += separator;
    append_text(out, n);
  }
  return out;
}

std::string array_of(detail::VtkXml& xml, const Grid& grid, const VoxelArray& array) {
  return std::visit(
      [&](const auto& values) {
        using Values = std::decay_t<decltype(values)>;
        if constexpr (std::is_same_v<Values, VectorSpans>)
          return xml.array<float>(array.name, 3, in_world(grid, values));
        else
          return xml.array(array.name, 1, values);
      },
      array.values);
}

template <class T>
void write_nrrd_bytes(const Grid& grid, std::span<const T> values, bool vectors, const std::filesystem::path& path) {
  const auto triple = [](const Vec3& v) { return "(" + joined(v, ",") + ")"; };
  std::string out = "NRRD0004\n# dynasurf\n";
  out += std::string("type: ") + (std::is_same_v<T, float> ? "float" : "uint8") + "\n";
  out += std::string("dimension: ") + (vectors ? "4" : "3") + "\nspace: left-posterior-superior\n";
  out += "sizes: " + std::string(vectors ? "3 " : "") + joined(grid.dims, " ") + "\n";
  out += std::string("space directions:") + (vectors ? " none" : "");
  for (int axis = 0; axis < 3; ++axis) out += " " + triple(grid.direction.col(axis) * grid.spacing[axis]);
  out += std::string("\nkinds:") + (vectors ? " vector" : "") + " domain domain domain\n";
  // Components lie along the axes of the world; without a measurement frame it is undefined along which.
  if (vectors) out += "measurement frame: (1,0,0) (0,1,0) (0,0,1)\n";
  out += "endian: little\nencoding: raw\nspace origin: " + triple(grid.origin) + "\n\n";
  out.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  write_file(path, out);
}

}  // namespace

void write_vti(const Grid& grid, std::span<const VoxelArray> arrays, const std::filesystem::path& path) {
  for (const VoxelArray& array : arrays)
    std::visit(
        [&](const auto& values) {
          if constexpr (std::is_same_v<std::decay_t<decltype(values)>, VectorSpans>)
            check_size(grid, values, path);
          else
            check_size(grid, values.size(), path);
        },
        array.values);

  detail::VtkXml xml;
  std::string data;
  for (const VoxelArray& array : arrays) data += array_of(xml, grid, array);
  const auto& d = grid.dims;
  // Values are point data, so the extent counts voxel centres, from 0 to the last.
  const std::string extent = joined(std::array{0, d[0] - 1, 0, d[1] - 1, 0, d[2] - 1}, " ");
  // VTK reads the matrix of directions row by row.
  const auto& m = grid.direction;
  const std::array rows{m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)};
  const std::string body = "<!-- dynasurf, world coordinates, LPS, mm -->\n<ImageData WholeExtent=\"" + extent +
                           "\" Origin=\"" + joined(grid.origin, " ") + "\" Spacing=\"" + joined(grid.spacing, " ") +
                           "\" Direction=\"" + joined(rows, " ") + "\">\n<Piece Extent=\"" + extent +
                           "\">\n<PointData>\n" + data + "</PointData>\n</Piece>\n</ImageData>\n";
  write_file(path, xml.file("ImageData", body));
}

void write_nrrd_volume(const Image& volume, const std::filesystem::path& path) {
  check_size(volume.grid, volume.values.size(), path);
  write_nrrd_bytes<float>(volume.grid, volume.values, false, path);
}

void write_nrrd_volume(const Mask& volume, const std::filesystem::path& path) {
  check_size(volume.grid, volume.values.size(), path);
  write_nrrd_bytes<std::uint8_t>(volume.grid, volume.values, false, path);
}

void write_nrrd_vectors(const Grid& grid, const VectorSpans& vectors, const std::filesystem::path& path) {
  check_size(grid, vectors, path);
  write_nrrd_bytes<float>(grid, in_world(grid, vectors), true, path);
}

}  // namespace dynasurf::io
