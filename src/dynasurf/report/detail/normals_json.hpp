#pragma once
#include "dynasurf/io/detail/json_node.hpp"
#include "dynasurf/report/detail/numbers.hpp"
#include "dynasurf/ventricle/measures/normal_limits.hpp"

namespace dynasurf::report::detail {

/// A normal map as an object of schema dynasurf.normals/1, and back. Throws InputError naming the file and the key.
Json normals_json(const ventricle::NormalMap& normal);
ventricle::NormalMap normals_in(const io::JsonNode& map);

}  // namespace dynasurf::report::detail
