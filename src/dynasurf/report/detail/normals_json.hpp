#pragma once
#include "dynasurf/io/detail/json_node.hpp"
#include "dynasurf/report/detail/numbers.hpp"
#include "dynasurf/ventricle/measures/normal_limits.hpp"

namespace dynasurf::report_detail {

/// A normal map as an object of schema dynasurf.normals/1, and back. Throws InputError naming the file and the key.
Json normals_json(const NormalMap& normal);
NormalMap normals_in(const JsonNode& map);

}  // namespace dynasurf::report_detail
