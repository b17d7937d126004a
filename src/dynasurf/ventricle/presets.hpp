#pragma once
#include <span>
#include <string_view>

#include "dynasurf/ventricle/options.hpp"

namespace dynasurf::ventricle {

/// Named sets of options: "psf_corrected", the default: surfaces on the largest gradient, then the fit through the
/// camera's blur; "edges" for the first alone; "thesis" for the pipeline exactly as it was published, where ours
/// differs; "pet", "mr" and "ct" for the default at their usual resolution: about 6 mm, which the data decide, and
/// none.
std::span<const std::string_view> preset_names();

/// Throws OptionError with the choices for an unknown name.
Options preset(std::string_view name);

}  // namespace dynasurf::ventricle
