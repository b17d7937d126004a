#pragma once
#include <span>
#include <string_view>

#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf {

/// Named sets of options: "default", and "thesis" for the pipeline exactly as it was published, where ours differs.
std::span<const std::string_view> preset_names();

/// Throws OptionError with the choices for an unknown name.
VentricleOptions ventricle_preset(std::string_view name);

}  // namespace dynasurf
