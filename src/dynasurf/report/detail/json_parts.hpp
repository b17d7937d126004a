#pragma once
#include "dynasurf/report/detail/numbers.hpp"
#include "dynasurf/report/provenance.hpp"

// What the results of both applications write alike.
namespace dynasurf::report::detail {

/// Throws OptionError when the options are neither empty nor JSON.
Json provenance_json(const Provenance& provenance);

}  // namespace dynasurf::report::detail
