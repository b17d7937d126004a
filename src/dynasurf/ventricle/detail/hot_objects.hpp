#pragma once
#include "dynasurf/core/study.hpp"
#include "dynasurf/heart/locate.hpp"

namespace dynasurf::ventricle {

/// The study with what is far brighter than the heart's wall cut to the brightness that a wall can have: gut, liver or
/// gallbladder beside the heart would set the thresholds of edges, which are shares of the brightest value.
/// Adds the note "study.hot_cut". Absent where the heart is not clearly seen or nothing is that bright.
std::optional<Study> cut_hot_objects(const Study& study, const heart::Location& heart);

}  // namespace dynasurf::ventricle
