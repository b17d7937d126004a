#pragma once
#include <string>
#include <vector>

#include "dynasurf/report/detail/lod_plan.hpp"

// What `dynasurf lod` works on.
namespace dynasurf::app {

/// The meshes of a result folder of `cloud`, or of files, finest first. `with_names`: files keep their names, else they
/// are level1, level2, ... Throws InputError, IoError.
std::vector<report::NamedLevel> levels_of(const std::vector<std::string>& paths, bool with_names);

}  // namespace dynasurf::app
