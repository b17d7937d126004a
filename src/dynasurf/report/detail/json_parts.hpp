#pragma once
#include "dynasurf/core/note.hpp"
#include "dynasurf/report/detail/numbers.hpp"
#include "dynasurf/report/provenance.hpp"

// What the results of both applications write alike.
namespace dynasurf::report::detail {

/// Throws OptionError when the options are neither empty nor JSON.
Json provenance_json(const Provenance& provenance);

/// Notes with the gate and the slice that they are of, from 1, null for all.
Json placed_notes_json(const Notes& notes);

}  // namespace dynasurf::report::detail
