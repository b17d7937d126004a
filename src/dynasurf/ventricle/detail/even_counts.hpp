#pragma once
#include <optional>

#include "dynasurf/core/study.hpp"
#include "dynasurf/heart/locate.hpp"

namespace dynasurf::ventricle {

/// The study with the counts of the usual gate (the median) in gates that have at least 5 % fewer or more, as those
/// have whose beats were cut short: "study.counts_scaled". Only where what lies beside the heart says the same, so that
/// it is the gate that is dim and not the heart. Absent where nothing is to be done: also for images that hold no
/// counts (DICOM's MR and CT, files that do not name their modality), fewer than four gates, and gates off by more than
/// a factor of three.
std::optional<Study> with_even_counts(const Study& study, const heart::Location& heart);

}  // namespace dynasurf::ventricle
