#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dynasurf/core/progress.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf::show {

/// One wall of one gate on its way from a border to a surface, in the frame of the border's grid.
struct ShownWall {
  Image border;
  Image map;        // what the field is made from: the border itself, or the edge map of pipeline direct
  TriMesh start;    // without triangles for pipeline contour
  TriMesh evolved;  // as its particles came to rest
  std::vector<std::array<int, 4>> histories;  // as of EvolutionResult
  std::optional<Image> drag = {};             // of each voxel, where it follows the image
};

/// What pictures of one gate are drawn from.
struct ShownGate {
  int gate = 0;  // 0-based
  Image image;
  Image labels;  // bits as in Labels, as numbers
  std::optional<ShownWall> endo, epi;
  ventricle::Options options;
  const std::optional<ShownWall>& of(ventricle::Border wall) const {
    return wall == ventricle::Border::endo ? endo : epi;
  }
};

/// Surfaces (world frame) and volumes of every gate. What is absent is empty or not finite.
struct ShownBeat {
  std::vector<double> time_ms;                                  // empty where the study tells none
  std::array<std::vector<std::optional<TriMesh>>, 2> surfaces;  // endo, epi
  std::array<std::vector<double>, 2> volume_ml, half_width_ml;
};

/// From RESULT/stages, which `dynasurf ventricle --keep-stages` writes. Throws InputError when it is not there or not
/// whole, OptionError for a gate that the result has not.
ShownGate gate_of_result(const std::filesystem::path& folder, int gate);
/// From a study, by the pipeline itself without the fit. Throws as `reconstruct`.
ShownGate gate_of_study(const Study& study, ventricle::Options options, int gate, const Progress& progress);

ShownBeat beat_of_result(const std::filesystem::path& folder);
ShownBeat beat_of_study(const Study& study, const ventricle::Options& options, const Progress& progress);

}  // namespace dynasurf::show
