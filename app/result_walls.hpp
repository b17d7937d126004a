#pragma once
#include <filesystem>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/ventricle/measures/measures.hpp"

namespace dynasurf::app {

/// Both surfaces of one gate of a result of `dynasurf ventricle`, read from its folder.
struct ResultWalls {
  TriMesh endo, epi;
  std::optional<ventricle::HeartAxes> axes;  // absent when the axis does not leave both surfaces
  bool is_fitted = false;                    // PSF-corrected
};

/// `gate` from 1. The surfaces of the reading that leads, or those of the edges when `edges` asks for them. Throws
/// InputError when the folder holds no such walls, OptionError for a gate that it has not.
ResultWalls read_result_walls(const std::filesystem::path& folder, int gate, bool edges = false);

}  // namespace dynasurf::app
