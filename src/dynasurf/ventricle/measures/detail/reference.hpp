#pragma once
#include <vector>

#include "dynasurf/ventricle/measures/detail/wall_map.hpp"

namespace dynasurf::ventricle {

/// The samples whose mean is 100 % of perfusion. Of counts: the brightest twentieth, as maps of counts are usually
/// scaled. Of a fitted uptake: the fifth around its upper quartile, for the brightest twentieth of values with errors
/// of their own is brighter than any wall. None where nothing has a value.
std::vector<std::size_t> reference_samples(const PolarValues& values, bool is_uptake);

}  // namespace dynasurf::ventricle
