#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/note.hpp"

namespace dynasurf::ventricle {

struct Gate;
struct Result;

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

/// Every reason to distrust a finished result (CARD-SANITY and the diagnostics of labelling, field and motion):
/// a surface that is missing or did not reach its border, walls that cross, a wall volume that beats, volumes or an
/// ejection fraction that no heart has, warnings of the stages.
std::vector<QualityFlag> assess(const Result& result);

/// The worst of the flags: none is `ok`, a warning is `check`, a failure is `fail`.
Verdict verdict_of(std::span<const QualityFlag> flags);

}  // namespace dynasurf::ventricle
