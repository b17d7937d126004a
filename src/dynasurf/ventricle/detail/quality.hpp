#pragma once
#include <span>
#include <vector>

#include "dynasurf/ventricle/result.hpp"

namespace dynasurf::ventricle {

/// Every reason to distrust a finished result (CARD-SANITY and the diagnostics of labelling, field and motion):
/// a surface that is missing or did not reach its border, walls that cross, a wall volume that beats, volumes or an
/// ejection fraction that no heart has, warnings of the stages.
std::vector<QualityFlag> assess(const Result& result);

/// The worst of the flags: none is `ok`, a warning is `check`, a failure is `fail`.
Verdict verdict_of(std::span<const QualityFlag> flags);

}  // namespace dynasurf::ventricle
