#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/ventricle/result.hpp"

namespace dynasurf::report {

/// What `--labels` and `--partial-volumes` ask for.
struct LabelOutput {
  std::string ending;  // of the files, nii.gz or nii; empty: no labels
  bool partial_volumes = false;
};
/// Throws OptionError for another ending, or for partial volumes without one. `where` names what was given.
void check_labels(const LabelOutput& labels, const std::string& where);

/// Both surfaces of a gate, world frame; null where there is none.
struct GateWalls {
  const TriMesh* endo = nullptr;
  const TriMesh* epi = nullptr;
};

/// Writes voxels of the walls, one volume per gate on the grid of `frame`, into `folder`: `walls.ENDING` with 1 for
/// the cavity, 2 for the wall, where half or more of the voxel lies inside; on request `part_cavity.ENDING` and
/// `part_wall.ENDING` with the part of each voxel (0..1, float32, exact but for rounding). A gate without both surfaces
/// has zeros. Throws IoError.
void write_wall_labels(std::span<const GateWalls> gates, const Study& frame, const LabelOutput& labels,
                       const std::filesystem::path& folder);

/// The same of a result, of the surfaces that lead, and the voxels of its labelled borders as `borders.ENDING`: 1 endo,
/// 2 epi, 3 both. `frame` is the study as it was read; borders that were found on another grid are those of the nearest
/// voxel.
void write_label_volumes(const ventricle::Result& result, const Study& frame, const LabelOutput& labels,
                         const std::filesystem::path& folder);

/// Whether the walls stand in the folder as they were asked for; where no labels were, they need not.
bool has_wall_labels(const LabelOutput& labels, const std::filesystem::path& folder);

}  // namespace dynasurf::report
