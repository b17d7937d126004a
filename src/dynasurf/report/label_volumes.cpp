#include "dynasurf/report/detail/label_volumes.hpp"

#include <algorithm>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/detail/label_io.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/mesh/marching.hpp"

namespace dynasurf::report {
namespace {

constexpr std::uint8_t cavity_label = 1, wall_label = 2;

struct Parts {
  Image cavity, wall;
};

Parts parts_of(const GateWalls& walls, const Grid& grid) {
  Parts parts{Image(grid), Image(grid)};
  if (walls.endo == nullptr || walls.epi == nullptr) return parts;
  parts.cavity = mesh::voxel_parts(grid, to_grid(grid, *walls.endo));
  parts.wall = mesh::voxel_parts(grid, to_grid(grid, *walls.epi));
  for (std::size_t v = 0; v < grid.size(); ++v)
    // Where the inner surface leaves the outer one, the difference would fall below 0.
    parts.wall.values[v] = std::max(0.0F, parts.wall.values[v] - parts.cavity.values[v]);
  return parts;
}

Mask labels_of(const Parts& parts) {
  Mask labels(parts.cavity.grid);
  for (std::size_t v = 0; v < labels.values.size(); ++v) {
    const float cavity = parts.cavity.values[v], heart = cavity + parts.wall.values[v];
    labels.values[v] = cavity >= 0.5F ? cavity_label : heart >= 0.5F ? wall_label : 0;
  }
  return labels;
}

/// The values of a mask at the centres of another grid's voxels; 0 outside it.
Mask on_grid(const Mask& mask, const Grid& grid) {
  Mask moved(grid);
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) {
        // The nearest voxel: labels cannot be interpolated.
        const Index3 v = voxel_of(mask.grid, to_grid(mask.grid, to_world(grid, centre_of(grid, {i, j, k}))));
        if (mask.grid.contains(v[0], v[1], v[2])) moved(i, j, k) = mask(v[0], v[1], v[2]);
      }
  return moved;
}

/// Where and when the gates are, with other values.
Study placed_as(const Study& frame, std::vector<Image> gates) {
  Study study;
  study.gates = std::move(gates);
  study.time_ms = frame.time_ms, study.cycle_ms = frame.cycle_ms;
  study.view = frame.view, study.slice_order = frame.slice_order;
  return study;
}

}  // namespace

void check_labels(const LabelOutput& labels, const std::string& where) {
  if (!labels.ending.empty() && labels.ending != "nii" && labels.ending != "nii.gz")
    throw OptionError(where + " is '" + labels.ending + "'; expected nii.gz or nii");
  if (labels.partial_volumes && labels.ending.empty())
    throw OptionError(where + ": expected nii.gz or nii with the partial volumes");
}

void write_wall_labels(std::span<const GateWalls> gates, const Study& frame, const LabelOutput& labels,
                       const std::filesystem::path& folder) {
  std::vector<Mask> walls(gates.size());
  std::vector<Image> cavity(gates.size()), wall(gates.size());
  parallel_for(gates.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      Parts parts = parts_of(gates[g], frame.grid());
      walls[g] = labels_of(parts);
      cavity[g] = std::move(parts.cavity), wall[g] = std::move(parts.wall);
    }
  });
  io::write_label_nifti(walls, frame, folder / ("walls." + labels.ending));
  if (!labels.partial_volumes) return;
  io::write_nifti(placed_as(frame, std::move(cavity)), folder / ("part_cavity." + labels.ending));
  io::write_nifti(placed_as(frame, std::move(wall)), folder / ("part_wall." + labels.ending));
}

bool has_wall_labels(const LabelOutput& labels, const std::filesystem::path& folder) {
  const auto stands = [&](const char* name) { return std::filesystem::exists(folder / (name + labels.ending)); };
  return labels.ending.empty() || (stands("walls.") && (!labels.partial_volumes || stands("part_wall.")));
}

void write_label_volumes(const ventricle::Result& result, const Study& frame, const LabelOutput& labels,
                         const std::filesystem::path& folder) {
  std::vector<GateWalls> walls;
  std::vector<Mask> borders;
  for (const ventricle::Gate& gate : result.gates) {
    const auto& [endo, epi, base] = gate.surfaces;
    walls.push_back({endo ? &endo->mesh : nullptr, epi ? &epi->mesh : nullptr});
    borders.push_back(on_grid(gate.labels.borders, frame.grid()));
  }
  write_wall_labels(walls, frame, labels, folder);
  io::write_label_nifti(borders, frame, folder / ("borders." + labels.ending));
}

}  // namespace dynasurf::report
