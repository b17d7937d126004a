#pragma once
#include <span>
#include <string>
#include <string_view>

#include "dynasurf/core/note.hpp"

namespace dynasurf::ventricle {

/// Whether a result can be trusted: yes; after a look at what the flags say; no.
enum class Verdict { ok, check, fail };
std::span<const std::string_view> names_of(Verdict);

/// One reason to distrust a result, with its number.
struct QualityFlag {
  std::string code;  // "surface_missing", "wall_volume_varies", ...
  Severity severity = Severity::warning;
  std::string message;
  double value = 0;
};

}  // namespace dynasurf::ventricle
